"""Disturbance of people: known values, the slow twin, and worlds in which it is not defined."""

import math
from dataclasses import fields, replace

import numpy as np
import pytest

from benchnav.arena.agents import Agents
from benchnav.arena.body import Body, Law, LawKind
from benchnav.arena.solid import Kind
from benchnav.arena.world import ContactRule
from benchnav.generation.undisturbed_world import undisturbed_world
from benchnav.metrics.measure import load_metric, measure
from benchnav.metrics.metric import evaluate
from benchnav.metrics.quantities.disturbance import disturbance
from benchnav.testing.episodes import RULES, Setting, Walk, box, record, straight, wave
from benchnav.testing.transform import moved, reordered
from tests.reference import disturbance as slow
from tests.worlds import disc

METRICS = ("people_delay", "people_detour")
SETTING = Setting(horizon=40.0)


def robot(seconds, driver=0):
    """A robot that arrives after some seconds, far from all people."""
    return Walk(straight((-15.0, 15.0), (1.0, 0.0)), (seconds - 15.0, 15.0), driver=driver)


def pause(walk, start, seconds):
    """The same walk with a pause."""

    def path(t):
        return walk.path(np.where(t < start, t, np.maximum(t - seconds, start)))

    return replace(walk, path=path)


def pair(walks, usual, seconds=10.0, setting=SETTING):
    """An episode of people beside a robot, which knows their usual walks without it."""
    alone = record([replace(walk, driver=walk.driver - 1) for walk in usual], setting)
    return replace(record([robot(seconds), *walks], setting), undisturbed=lambda: alone)


def values(episode):
    members = episode.world.agents.evaluated
    return tuple(evaluate(load_metric(name), episode, members)[0] for name in METRICS)


def person(speed=1.0, y=0.0, goal=(8.0, 0.0), driver=1):
    return Walk(straight((0.0, y), (speed, 0.0)), goal, preferred_speed=speed, driver=driver)


@pytest.mark.parametrize(("seconds", "expected"), [(12.0, 1.5), (5.0, 1.5), (3.2, 1.0)])
def test_a_person_that_waits_is_late_by_that_time(seconds, expected):
    """Also if the record ends before it arrives, or, with the time so far, while it waits."""
    walk = person()
    delay, detour = values(pair([pause(walk, 2.0, 1.5)], [walk], seconds))
    assert delay == pytest.approx(expected, abs=1e-6)
    assert detour == pytest.approx(0.0, abs=1e-9)


def test_the_mean_is_over_all_people():
    walks = [person(y=0.4 * k, goal=(8.0, 0.4 * k)) for k in range(4)]
    found = pair([pause(walks[0], 2.0, 2.0), *walks[1:]], walks)
    assert values(found)[0] == pytest.approx(0.5)


def test_a_person_on_its_way_is_late_by_its_lag_at_its_preferred_speed():
    slowed = Walk(straight((0.0, 0.0), (0.5, 0.0)), (30.0, 0.0), preferred_speed=1.25, driver=1)
    usual = replace(slowed, path=straight((0.0, 0.0), (1.25, 0.0)))
    delay, _ = values(pair([slowed], [usual], seconds=10.0))
    assert delay == pytest.approx(10.0 * 0.75 / 1.25, rel=0.03)  # the robot's tolerance


def test_an_evasion_is_a_detour():
    usual = person(goal=(8.0, 0.0))
    evades = replace(usual, path=wave((0.0, 0.0), 1.0, 0.5, 4.0))
    delay, detour = values(pair([evades], [usual], seconds=12.0))
    t = np.linspace(0.0, 1.0, 100_001)
    arc = 8.0 * np.trapezoid(np.hypot(1.0, 0.5 * math.pi / 2.0 * np.cos(4.0 * math.pi * t)), t)
    assert detour == pytest.approx(arc - 8.0, rel=0.04)
    assert abs(delay) < 0.05  # it reaches the goal disc at another angle


def test_a_person_that_a_collision_stops_never_gets_on():
    usual = person()
    stopped = replace(usual, ends=2.0)
    setting = replace(SETTING, rules=replace(RULES, contact=ContactRule.END))
    delay, _ = values(pair([stopped], [usual], 10.0, setting))
    end = len(pair([stopped], [usual], 10.0, setting).requested) * setting.dt
    assert delay == pytest.approx(end + 5.8 - 7.8)


def test_a_robot_that_makes_way_can_speed_people_up():
    walk = person()
    delay, _ = values(pair([walk], [pause(walk, 2.0, 1.5)], seconds=12.0))
    assert delay == pytest.approx(-1.5, abs=1e-6)


def test_people_of_two_navigators_are_compared_while_both_records_last():
    """The undisturbed record ends when those of the first navigator arrived."""
    first, other = person(speed=2.0), person(y=1.0, goal=(30.0, 1.0), driver=2)
    found = pair([first, pause(other, 1.0, 0.5)], [first, other], seconds=10.0)
    assert len(found.undisturbed().requested) < len(found.requested)
    assert values(found)[0] == pytest.approx(0.25, abs=1e-6)


def test_remaining_ways_lead_around_walls():
    """Behind a wall, a metre to the side is more than a metre of the way."""
    setting = replace(SETTING, solids=(box((4.0, 0.0), 1.0, 6.0),))
    usual = Walk(straight((0.0, 0.0), (0.0, 0.1)), (8.0, 0.0), driver=1)
    other = replace(usual, path=straight((0.0, 0.0), (0.0, -0.1)))
    still = replace(usual, path=straight((0.0, 0.0), (0.0, 0.0)))
    same = values(pair([other], [usual], setting=setting))
    assert same == pytest.approx((0.0, 0.0), abs=1e-9)
    nearer = values(pair([usual], [still], setting=setting))[0]
    assert -1.0 < nearer < -0.5


def crowd(seed, drivers=2):
    """People who walk at random, beside a robot and without it."""
    rng = np.random.default_rng(seed)
    walks, usual = [], []
    for k in range(7):
        start, goal = rng.uniform(-6.0, 6.0, (2, 2))
        speed = rng.uniform(0.5, 1.5)
        course = speed * (goal - start) / np.hypot(*(goal - start))
        walk = Walk(
            straight(tuple(start), tuple(course)), tuple(goal), preferred_speed=speed,
            driver=1 + k % drivers,
        )  # fmt: skip
        off = tuple(course * rng.uniform(0.3, 1.2) + rng.normal(0.0, 0.1, 2))
        usual.append(walk)
        walks.append(replace(walk, path=straight(tuple(start), off)))
    return pair(walks, usual, float(rng.uniform(4.0, 12.0)))


@pytest.mark.parametrize("seed", range(6))
def test_values_agree_with_their_slow_twin(seed):
    episode = crowd(seed)
    found = disturbance(episode, episode.undisturbed())
    for got, expected in zip(found, slow.disturbance(episode, episode.undisturbed()), strict=True):
        np.testing.assert_allclose(got, expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_neither_place_nor_order_matters(seed):
    episode = crowd(seed)
    other = episode.undisturbed()
    turned = replace(
        moved(episode, 0.7, (3.0, -2.0)), undisturbed=lambda: moved(other, 0.7, (3, -2))
    )
    assert values(turned) == pytest.approx(values(episode), rel=1e-6)
    order = np.roll(np.arange(8)[::-1], 1)
    people = [a - 1 for a in order if a > 0]
    mixed = replace(reordered(episode, order), undisturbed=lambda: reordered(other, people))
    assert values(mixed) == pytest.approx(values(episode), rel=1e-9)


def test_the_undisturbed_world_has_the_same_people_in_the_same_order():
    world = crowd(0).world
    people = undisturbed_world(world)
    for field in fields(Agents):
        own = getattr(world.agents, field.name)[world.people[0]]
        shift = 1 if field.name == "driver" else 0
        np.testing.assert_array_equal(getattr(people.agents, field.name), own - shift)
    assert people.solids == world.solids
    assert not undisturbed_world(record([robot(3.0)]).world).agents.radius.size


def reason(episode):
    metrics = [load_metric(name) for name in METRICS]
    (why,) = {row["missing"] for row in measure(episode, metrics)}
    return why


def test_the_reason_why_it_is_not_applicable():
    walk = person()
    episode = pair([walk], [walk])
    assert reason(episode) == ""
    assert reason(record([robot(3.0)])) == "n/a: needs people"
    law = Law(LawKind.TRACK, np.array([0.0, 9.0]), np.array([[0.0, 5.0], [9.0, 5.0]]))
    recorded = Body(disc(Kind.DYNAMIC, 0.0, 0.0, 0.2), law, person=True)
    paths = {"bodies": (recorded,), "body_paths": (straight((0.0, 5.0), (1.0, 0.0)),)}
    beside = record([robot(3.0)], replace(SETTING, **paths))
    assert reason(beside).startswith("n/a: needs people who react: recorded people without")
    expected = "n/a: needs the undisturbed world: key `undisturbed` of the suite"
    assert reason(replace(episode, undisturbed=None)) == expected
    assert reason(replace(episode, undisturbed=lambda: None)) == expected
    failed = replace(episode.undisturbed(), failure="it stumbled")
    broken = replace(episode, undisturbed=lambda: failed)
    assert reason(broken) == "n/a: the undisturbed world failed: it stumbled"
    assert np.isnan(values(broken)).all()


def test_an_episode_without_a_decision_has_no_value():
    walk = person()
    episode = pair([walk], [walk])
    none = ("requested", "executed")
    states = ("position", "heading", "status", "body_position")
    short = {name: getattr(episode, name)[:0] for name in none}
    short |= {name: getattr(episode, name)[:1] for name in states}
    assert np.isnan(values(replace(episode, failure="no", **short))).all()
