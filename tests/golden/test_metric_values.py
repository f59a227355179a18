"""Trajectories whose metrics are known in closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import erf

from benchnav.arena.agents import Role
from benchnav.arena.solid import Kind
from benchnav.arena.world import Afterwards
from benchnav.metrics import efficiency, following, safety, smoothness, success
from benchnav.metrics.quantities.lowpass import SIGMA
from benchnav.testing.episodes import (
    RULES,
    Hit,
    Setting,
    Walk,
    box,
    circle,
    minimum_jerk,
    record,
    room,
    stop_and_go,
    straight,
    wave,
)


def test_straight_line():
    """8 m to the middle of the goal, 0.2 m of tolerance, 1 m/s, preferred speed 1.25 m/s."""
    walk = Walk(straight((0.0, 0.0), (1.0, 0.0)), (8.0, 0.0), preferred_speed=1.25)
    episode = record([walk])
    assert success.success(episode) == [1.0]
    assert efficiency.time_to_goal(episode) == pytest.approx([7.8], abs=1e-6)
    assert efficiency.path_length(episode) == pytest.approx([7.8], abs=1e-6)
    assert efficiency.geodesic_length(episode) == pytest.approx([7.8], abs=1e-6)
    assert efficiency.efficiency(episode) == pytest.approx([1.0], abs=1e-6)
    assert efficiency.spl(episode) == pytest.approx([1.0], abs=1e-6)
    assert efficiency.sct(episode) == pytest.approx([0.8], abs=1e-6)
    assert efficiency.makespan(episode, np.array([True])) == pytest.approx(7.8, abs=1e-6)
    assert smoothness.turning(episode) == pytest.approx([0.0], abs=1e-9)


def test_straight_line_has_the_jerk_of_its_one_step_of_velocity():
    """A Gaussian-smoothed step has ∫ v̈² dt = v² / (4 √π σ³)."""
    walk = Walk(straight((0.0, 0.0), (1.0, 0.0)), (10.2, 0.0))
    expected = -math.log(10.0**3 / (4.0 * math.sqrt(math.pi) * SIGMA**3))
    found = smoothness.log_dimensionless_jerk(record([walk]))[0]
    assert found == pytest.approx(expected, abs=0.15)  # differences of 1/20 s against σ = 0.13 s


@pytest.mark.parametrize("dt", [0.05, 0.1, 0.25])
def test_circle(dt):
    """A three-quarter circle of radius 2 m at 1 m/s: curvature 1/2, efficiency chord / arc."""
    tolerance = replace(RULES, goal_tolerance=1e-3)
    goal = (0.0, -2.0)
    episode = record([Walk(circle((0.0, 0.0), 2.0, 1.0), goal)], Setting(dt=dt, rules=tolerance))
    arc = 3.0 * math.pi
    assert efficiency.path_length(episode) == pytest.approx([arc], rel=1e-3)
    assert efficiency.time_to_goal(episode) == pytest.approx([arc], rel=1e-3)
    assert efficiency.efficiency(episode) == pytest.approx([2.0 * math.sqrt(2.0) / arc], rel=2e-3)
    assert smoothness.turning(episode) == pytest.approx([0.5], rel=0.03)


def test_s_curve():
    """Two full waves of y = h sin(kx): turning 8 atan(hk) over the arc length of the wave."""
    height, length = 0.8, 4.0
    k = 2.0 * math.pi / length
    arc, _ = quad(lambda x: math.hypot(1.0, height * k * math.cos(k * x)), 0.0, 8.0)
    # angle goes from atan(hk) down and up: four half-waves of 2 atan(hk) each
    expected = 8.0 * math.atan(height * k) / arc
    rules = replace(RULES, goal_tolerance=1e-3)
    episode = record(
        [Walk(wave((0.0, 0.0), 0.8, height, length), (8.0, 0.0))], Setting(rules=rules)
    )
    assert efficiency.path_length(episode) == pytest.approx([arc], rel=2e-3)
    assert smoothness.turning(episode) == pytest.approx([expected], rel=0.02)


def test_minimum_jerk_has_dimensionless_jerk_204_8():
    """720 L²/T⁵ · T³ / (15/8 · L/T)² = 204.8 (Hogan & Sternad 2009)."""
    rules = replace(RULES, goal_tolerance=1e-7)
    walk = Walk(minimum_jerk((0.0, 0.0), (6.0, 2.0), 18.0), (6.0, 2.0))
    found = smoothness.log_dimensionless_jerk(record([walk], Setting(rules=rules)))[0]
    assert found == pytest.approx(-math.log(204.8), abs=0.1)


def test_dimensionless_jerk_itself_is_exact():
    t = np.linspace(0.0, 4.0, 4001)
    s = t / 4.0
    speed = 3.0 / 4.0 * 30.0 * s**2 * (1.0 - s) ** 2
    velocity = np.stack([speed, np.zeros_like(speed)], axis=1)
    assert smoothness.dimensionless_jerk(velocity, 4.0, 1000.0) == pytest.approx(204.8, rel=2e-3)


def test_spectral_arc_length_of_a_bell_is_a_pure_number():
    """The spectrum of a Gaussian is one: exp(−ln 20 · u²) up to the threshold of 1/20."""
    ln20 = math.log(20.0)
    expected, _ = quad(lambda u: math.hypot(1.0, 2.0 * ln20 * u * math.exp(-ln20 * u * u)), 0, 1)
    for width in (0.5, 1.0, 2.0):
        t = np.arange(-10.0, 10.0, 0.05)
        found = smoothness.spectral_arc_length(np.exp(-0.5 * (t / width) ** 2), 20.0)
        assert found == pytest.approx(-expected, abs=0.01)


def test_sparc_of_a_walk_whose_speed_is_a_bell():
    width, middle = 1.2, 6.0

    def path(t):
        x = width * math.sqrt(0.5 * math.pi) * erf((t - middle) / (width * math.sqrt(2.0)))
        return np.stack([x, np.zeros_like(x)], axis=1)

    ln20 = math.log(20.0)
    expected, _ = quad(lambda u: math.hypot(1.0, 2.0 * ln20 * u * math.exp(-ln20 * u * u)), 0, 1)
    rules = replace(RULES, goal_tolerance=1e-3)
    episode = record([Walk(path, (float(path(np.array([99.0]))[0, 0]), 0.0))], Setting(rules=rules))
    assert smoothness.sparc(episode) == pytest.approx([-expected], abs=0.02)


def test_stop_and_go_is_less_smooth_than_going():
    rules = replace(RULES, goal_tolerance=1e-2)
    setting = Setting(rules=rules)
    going = record([Walk(minimum_jerk((0.0, 0.0), (8.0, 0.0), 16.0), (8.0, 0.0))], setting)
    halting = record([Walk(stop_and_go((0.0, 0.0), 0.5, 4.0), (8.0, 0.0))], setting)
    assert smoothness.sparc(halting)[0] < smoothness.sparc(going)[0] - 0.5
    assert (
        smoothness.log_dimensionless_jerk(halting)[0]
        < smoothness.log_dimensionless_jerk(going)[0] - 1.0
    )
    assert efficiency.path_length(halting) == pytest.approx([8.0], abs=0.02)
    assert smoothness.turning(halting) == pytest.approx([0.0], abs=1e-9)


def test_stationary_agent_is_stuck_and_has_no_smoothness_and_no_efficiency():
    episode = record([Walk(straight((0.0, 0.0), (0.0, 0.0)), (5.0, 0.0))])
    assert success.stuck(episode) == [1.0]
    assert success.timeout(episode) == [1.0]
    assert success.success(episode) == [0.0]
    assert efficiency.path_length(episode) == [0.0]
    assert efficiency.spl(episode) == [0.0]
    for metric in (
        efficiency.efficiency, efficiency.time_to_goal, smoothness.turning, smoothness.sparc,
        smoothness.log_dimensionless_jerk,
    ):  # fmt: skip
        assert np.isnan(metric(episode)).all()


def test_agent_that_starts_at_its_goal_did_not_travel_efficiently():
    episode = record([Walk(straight((0.0, 0.0), (0.0, 0.0)), (0.1, 0.0))])
    assert success.success(episode) == [1.0]
    assert efficiency.time_to_goal(episode) == [0.0]
    assert np.isnan(efficiency.efficiency(episode)).all()
    assert np.isnan(efficiency.spl(episode)).all()


def test_crash_at_once():
    """One metre straight into a wall, and out: no smoothness, no efficiency, no clearance."""
    bounds = (-5.0, -5.0, 5.0, 5.0)
    walk = Walk(straight((3.7, 0.0), (1.0, 0.0)), (4.5, 4.5), hits=(Hit(1.0, 0.0),), ends=1.0)
    episode = record([walk], Setting(bounds=bounds, solids=(room(bounds),)))
    assert len(episode.position) == 11
    assert success.success(episode) == [0.0]
    assert success.timeout(episode) == [0.0]
    assert success.stuck(episode) == [0.0]
    assert safety.collided(episode) == [1.0]
    assert safety.collisions_wall(episode) == [1.0]
    assert safety.min_clearance(episode) == pytest.approx([0.0], abs=1e-12)
    assert safety.min_time_to_collision(episode) == [0.0]
    assert np.isnan(efficiency.efficiency(episode)).all()
    assert efficiency.spl(episode) == [0.0]
    assert np.isnan(smoothness.turning(episode)).all()


def test_timeout_on_the_way():
    episode = record([Walk(straight((0.0, 0.0), (0.5, 0.0)), (15.0, 0.0))])
    assert success.timeout(episode) == [1.0]
    assert success.stuck(episode) == [0.0]
    assert success.arrival(episode) == [0.0]
    assert efficiency.path_length(episode) == pytest.approx([10.0])


def test_two_agents_that_pass_each_other():
    """1.1 m apart, rims 0.5 m: within 1.2 m rim to rim while |x| ≤ √(1.8² − 1.1²) apart."""
    rules = replace(RULES, on_arrival=Afterwards.STAY)
    walks = [
        Walk(straight((-6.0, 0.0), (1.0, 0.0)), (6.0, 0.0)),
        Walk(straight((6.0, 1.1), (-1.0, 0.0)), (-6.0, 1.1)),
    ]
    episode = record(walks, Setting(rules=rules))
    assert safety.min_clearance(episode) == pytest.approx([0.5, 0.5], abs=1e-9)
    close = math.sqrt(1.8**2 - 1.1**2)  # |x1 - x2| = 2 |t - 6|
    assert safety.personal_space_personal(episode) == pytest.approx(
        close / episode.arrival, rel=0.01
    )
    assert safety.personal_space_intimate(episode) == pytest.approx([0.0, 0.0])
    assert safety.min_time_to_collision(episode) == pytest.approx([5.0, 5.0])


def test_head_on_course_that_is_left_in_time():
    """Closing at 2 m/s from 10 m apart (gap 9.4), until both stand after 3 s: 3.4 m are left."""

    def approach(x, sign):
        return lambda t: np.stack([x + sign * np.minimum(t, 3.0), np.zeros_like(t)], axis=1)

    walks = [Walk(approach(-5.0, 1.0), (9.0, 0.0)), Walk(approach(5.0, -1.0), (-9.0, 0.0))]
    episode = record(walks, Setting(dt=0.1, horizon=12.0))
    expected = 3.4 / 2.0
    assert safety.min_time_to_collision(episode) == pytest.approx([expected] * 2, abs=1e-9)
    assert safety.min_clearance(episode) == pytest.approx([3.4] * 2, abs=1e-9)


def test_clearance_is_found_between_states():
    """At 1 m a step past the corner of a box: no state is near it, the motion is."""
    walk = Walk(straight((-3.5, 1.0), (1.0, 0.0)), (9.0, 1.0), radius=0.2)
    episode = record([walk], Setting(dt=1.0, solids=(box((0.0, 0.0), 0.2, 1.0),)))
    assert safety.min_clearance(episode) == pytest.approx([0.3], abs=1e-12)


def test_wider_detour_is_less_efficient_and_noise_turns_more():
    rules = replace(RULES, goal_tolerance=1e-2)
    found = [
        record([Walk(wave((0.0, 0.0), 0.8, height, 16.0), (8.0, 0.0))], Setting(rules=rules))
        for height in (0.0, 0.5, 1.0, 2.0)
    ]
    share = [float(efficiency.efficiency(e)[0]) for e in found]
    assert share == sorted(share, reverse=True)
    assert share[0] > share[-1] + 0.05
    rng = np.random.default_rng(0)
    noise = rng.normal(0.0, 1.0, (400, 2))

    def shaken(scale):
        def path(t):
            index = np.minimum(np.round(t / 0.1).astype(int), 399)
            return np.stack([0.8 * t, np.zeros_like(t)], axis=1) + scale * noise[index]

        return path

    shaken_walks = [
        record([Walk(shaken(scale), (8.0, 0.0), radius=0.1)]) for scale in (0.0, 0.005, 0.02)
    ]
    turning = [float(smoothness.turning(e)[0]) for e in shaken_walks]
    jerk = [float(smoothness.log_dimensionless_jerk(e)[0]) for e in shaken_walks]
    assert turning == sorted(turning)
    assert jerk == sorted(jerk, reverse=True)
    assert turning[0] < turning[-1]
    assert jerk[0] > jerk[-1]


def test_events_are_counted_by_kind_and_only_when_charged():
    hits = (
        Hit(1.0, 0.5, Kind.WALL, 0), Hit(1.2, 0.5, Kind.STATIC, 1), Hit(2.0, 0.5, Kind.AGENT, 1),
        Hit(3.0, 0.5, Kind.AGENT, 1, charged=False), Hit(4.0, 1.0, Kind.DYNAMIC, -1),
    )  # fmt: skip
    walks = [
        Walk(straight((0.0, 0.0), (1.0, 0.0)), (8.0, 0.0), hits=hits),
        Walk(straight((0.0, 5.0), (1.0, 0.0)), (8.0, 5.0), hits=(Hit(2.0, 1.0, charged=False),)),
    ]
    episode = record(walks)
    assert safety.collisions_wall(episode).tolist() == [1.0, 0.0]
    assert safety.collisions_static(episode).tolist() == [1.0, 0.0]
    assert safety.collisions_agent(episode).tolist() == [1.0, 0.0]
    assert safety.collisions_dynamic(episode).tolist() == [1.0, 0.0]
    assert safety.collided(episode).tolist() == [1.0, 0.0]
    assert safety.contact_time(episode) == pytest.approx([0.7 + 0.5 + 1.0, 0.0])
    assert success.success(episode).tolist() == [0.0, 1.0]


def test_two_followers_along_an_s_curve():
    """Each at a fixed distance from the curve, along its normal, one on either side."""
    height, length = 0.8, 8.0
    k = 2.0 * math.pi / length

    def beside(distance):
        def path(t):
            x = 1.0 + 0.8 * t
            slope = height * k * np.cos(k * x)
            normal = np.stack([-slope, np.ones_like(slope)], axis=1) / np.hypot(1.0, slope)[:, None]
            return np.stack([x, height * np.sin(k * x)], axis=1) + distance * normal

        return path

    walks = [
        Walk(wave((0.0, 0.0), 1.2, height, length), (90.0, 0.0)),
        Walk(beside(0.4), (90.0, 0.0), radius=0.1, role=Role.FOLLOWER),
        Walk(beside(-0.7), (90.0, 0.0), radius=0.1, role=Role.FOLLOWER),
    ]
    for dt in (0.05, 0.1):
        found = following.path_keeping(record(walks, Setting(dt=dt, horizon=12.0)))
        assert found[1:] == pytest.approx([0.4, 0.7], rel=0.01)
    # 1.1 m apart, link 0.6 m: two parts of one each, of which nobody is behind the other
    assert np.isnan(following.catch_up_time(record(walks))).all()
