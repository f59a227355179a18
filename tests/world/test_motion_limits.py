"""Limits of acceleration, wheels and steering, against a slow twin; no limit is ever exceeded."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchnav.arena.agents import Dynamics
from benchnav.envs.autoreset import AutoresetSimulation
from benchnav.kernels import kernel
from benchnav.verify.reference.reference_dynamics import Drive
from benchnav.world.dynamics import limited
from benchnav.world.motion_limits import approached, limit_records, within_limits
from benchnav.world.simulation import Simulation
from tests.worlds import agents, limited_world, random_world, world

DT = 0.2
LIMITS = {
    Dynamics.HOLONOMIC: {},
    Dynamics.UNICYCLE: {"reverse": True},
    Dynamics.DIFFERENTIAL_DRIVE: {"track_width": 0.6, "max_wheel_speed": 1.5, "reverse": True},
    Dynamics.ACKERMANN: {
        "wheelbase": 0.5, "max_steering_angle": 0.6, "max_steering_rate": 1.5, "reverse": True,
    },
}  # fmt: skip
SLOW = {"max_acceleration": 1.0, "max_deceleration": 2.0, "max_turn_acceleration": 4.0}
positive = st.floats(0.05, 20.0)
limit = positive | st.just(math.inf)
number = st.floats(-8, 8).map(lambda x: round(x, 6)) | st.just(0.0)
commands = st.tuples(number, number)


@kernel
def replayed(requested, twist, heading, records, dt, executed, steering):
    d0, d1 = 0.0, 0.0
    for t in range(len(requested)):
        d0, d1 = within_limits(
            requested[t, 0], requested[t, 1], twist, heading[t], d0, d1, records[0], dt
        )
        executed[t, 0], executed[t, 1] = d0, d1
        steering[t] = records[0].steering


def executed_of(body, requested, twist, heading, dt=DT):
    """The commands (T, 2) that a body executes from rest, and its steering angles (T,)."""
    requested = np.array(requested, float).reshape(-1, 2)
    executed, steering = np.empty_like(requested), np.empty(len(requested))
    heading = np.broadcast_to(np.asarray(heading, float), steering.shape).copy()
    replayed(requested, twist, heading, limit_records(body), dt, executed, steering)
    return executed, steering


@st.composite
def bodies(draw):
    kind = draw(st.sampled_from(Dynamics))
    drive = {name: draw(limit) for name in ("max_acceleration", "max_deceleration")}
    if kind is Dynamics.DIFFERENTIAL_DRIVE:
        drive |= {"track_width": draw(positive), "max_wheel_speed": draw(positive)}
    if kind is Dynamics.ACKERMANN:
        angle = draw(st.floats(0.05, 1.5))
        drive |= {"wheelbase": draw(positive), "max_steering_angle": angle}
        drive |= {"max_steering_rate": draw(limit)}
    else:
        drive["max_turn_acceleration"] = draw(limit)
    if kind is not Dynamics.HOLONOMIC:
        drive["reverse"] = draw(st.booleans())
    return agents([0, 0], [9, 9], speed=draw(positive), unicycle=kind, **drive)


drives = st.lists(st.tuples(commands, st.floats(-math.pi, math.pi)), min_size=1, max_size=30)


@settings(max_examples=400, deadline=None)
@given(bodies(), drives, st.booleans(), st.sampled_from([0.05, 0.2, 1.0]))
def test_commands_agree_with_the_slow_twin(body, drive, twist, dt):
    requested, heading = [c for c, _ in drive], [angle for _, angle in drive]
    executed, steering = executed_of(body, requested, twist, heading, dt)
    twin = Drive(body, 0, dt, np.zeros(2))
    for t, command in enumerate(requested):
        expected = twin.executed(np.array(command), twist, heading[t])
        if twin.doubtful:
            return
        np.testing.assert_allclose(executed[t], expected, rtol=1e-7, atol=1e-9)
        assert steering[t] == pytest.approx(twin.steering, abs=1e-9)
        twin.command = executed[t]


@settings(max_examples=400, deadline=None)
@given(bodies(), drives, st.booleans(), st.sampled_from([0.05, 0.2, 1.0]))
def test_no_limit_is_ever_exceeded(body, drive, twist, dt):
    executed, steering = executed_of(body, [c for c, _ in drive], twist, [a for _, a in drive], dt)
    assert np.isfinite(executed).all()
    assert np.isfinite(steering).all()
    within = 1.0 + 1e-9
    before = np.vstack([[0.0, 0.0], executed[:-1]])
    kind = Dynamics(int(body.dynamics[0]))
    top, turn = body.max_speed[0] * within, body.max_turn_rate[0] * within
    if kind is Dynamics.HOLONOMIC and not twist:
        speed, change = np.hypot(*executed.T), np.hypot(*(executed - before).T)
        assert speed.max() <= top
        assert (change <= most_change(body, dt) * within + 1e-9).all()
        check_speeds(np.hypot(*before.T), speed, body, dt)
        return
    v, w = executed.T
    assert abs(v).max() <= top
    assert abs(w).max() <= turn
    assert body.reverse[0] or v.min() >= 0.0
    for forward in (1.0, -1.0):  # each direction counts as a speed of its own
        check_speeds(np.maximum(forward * before[:, 0], 0), np.maximum(forward * v, 0), body, dt)
    assert (abs(v - before[:, 0]) <= most_change(body, dt) * within + 1e-9).all()
    if kind is Dynamics.ACKERMANN:
        angle, rate = body.max_steering_angle[0], body.max_steering_rate[0]
        assert abs(steering).max() <= angle
        assert abs(np.diff(steering, prepend=0.0)).max() <= rate * dt * within
        np.testing.assert_allclose(
            w * body.wheelbase[0], v * np.tan(steering), rtol=1e-9, atol=1e-99
        )
    else:
        most = body.max_turn_acceleration[0] * dt * within + 1e-12
        assert (abs(w - before[:, 1]) <= most).all()
        wheels = abs(v) + abs(w) * 0.5 * body.track_width[0]
        assert wheels.max() <= body.max_wheel_speed[0] * within


def most_change(body, dt):
    return max(body.max_acceleration[0], body.max_deceleration[0]) * dt


def check_speeds(before, after, body, dt):
    assert (after - before <= body.max_acceleration[0] * dt + 1e-9).all()
    assert (before - after <= body.max_deceleration[0] * dt + 1e-9).all()


@settings(max_examples=100, deadline=None)
@given(st.booleans(), drives, st.booleans())
def test_without_limits_the_bits_are_those_of_worlds_without_limits(unicycle, drive, twist):
    body = agents([0, 0], [9, 9], unicycle=unicycle)
    requested, heading = [c for c, _ in drive], [angle for _, angle in drive]
    executed, _ = executed_of(body, requested, twist, heading)
    plain = np.array([
        limited(*map(float, c), twist, unicycle, float(a), 2.0, 2.5, DT)
        for c, a in zip(requested, heading, strict=True)
    ])  # fmt: skip
    np.testing.assert_array_equal(executed, plain)


def test_speed_falls_at_the_deceleration_and_then_rises_at_the_acceleration():
    assert approached(1.0, 0.0, 3.0, 0.0, 2.0, 4.0, 0.5) == (2.0, 0.0)
    assert approached(3.0, 0.0, 0.0, 0.0, 2.0, 4.0, 0.5) == (1.0, 0.0)
    assert approached(1.0, 0.0, -3.0, 0.0, 2.0, 4.0, 0.5) == (-0.5, 0.0)  # ¼ s and ¼ s
    assert approached(0.0, 1.0, 1.0, 0.0, math.inf, math.inf, 0.5) == (1.0, 0.0)
    across = approached(0.0, 2.0, 2.0, 0.0, 1.0, 4.0, 0.5)  # half of the way brakes
    falling = math.sqrt(2.0)
    way = falling + (0.5 - falling / 4.0) * 1.0
    assert across == pytest.approx((way / falling, 2.0 - way / falling))


def test_wheels_scale_a_command_down_on_its_curve():
    body = agents([0, 0], [9, 9], unicycle=2, track_width=0.5, max_wheel_speed=1.0)
    (executed,), _ = executed_of(body, [(2.0, 4.0)], True, 0.0)
    assert executed == pytest.approx([1.0 / 1.3125, 1.25 / 1.3125 * 2.0 / 2.0])
    assert executed[0] + 0.25 * executed[1] == pytest.approx(1.0)


def test_an_ackermann_body_stands_when_it_is_to_turn_on_the_spot_but_steers():
    body = agents([0, 0], [9, 9], unicycle=3, **LIMITS[Dynamics.ACKERMANN])
    executed, steering = executed_of(body, [(0, 1), (0, 1), (0, 1), (0, 0), (1, 0)], True, 0.0)
    assert not executed[:4].any()
    assert steering == pytest.approx([0.3, 0.6, 0.6, 0.6, 0.3])
    assert executed[4] == pytest.approx([1.0, math.tan(0.3) / 0.5])


def settled(kind, limits, aim, steps=120, dt=DT):
    """Follow one planar velocity; return speeds and errors of heading over time."""
    limits = limits | ({"max_turn_acceleration": math.inf} if kind is Dynamics.ACKERMANN else {})
    crew = agents([50, 50], [90, 90], unicycle=kind, **limits)
    simulation = Simulation([world(crew, side=100.0, steps=steps + 1, tolerance=0.1)])
    error = []
    for _ in range(steps):
        command = np.array([[[math.cos(aim), math.sin(aim)]]])
        simulation.step(command, np.zeros((1, 1), bool))
        error.append(math.remainder(float(simulation.heading[0, 0]) - aim, 2.0 * math.pi))
    return np.array(error), simulation


@pytest.mark.parametrize("kind", [k for k in Dynamics if k != Dynamics.HOLONOMIC])
@pytest.mark.parametrize("aim", [0.0, 0.5, 1.5, -1.6, 3.0, math.pi])
@pytest.mark.parametrize("reverse", [False, True])
def test_a_planar_velocity_is_faced_and_kept(kind, aim, reverse):
    """No body stays where it is, or swings about the direction that it was given."""
    error, simulation = settled(kind, LIMITS[kind] | SLOW | {"reverse": reverse}, aim)
    off = abs(error[-20:])
    if reverse and abs(aim) > math.pi / 2:
        off = math.pi - off
    assert off.max() < 1e-3
    assert simulation.velocity[0, 0] == pytest.approx([math.cos(aim), math.sin(aim)], abs=2e-3)


@settings(max_examples=100, deadline=None)
@given(
    st.sampled_from([k for k in Dynamics if k != Dynamics.HOLONOMIC]),
    st.lists(st.tuples(st.floats(-1, 1), st.floats(-3, 3)), min_size=1, max_size=20),
    st.floats(-3, 3),
)
def test_the_way_back_is_the_way(kind, twists, heading):
    """A free body that can reverse returns, if its executed twists are reversed."""
    crew = agents([50, 50], [90, 90], unicycle=kind, heading=heading, **LIMITS[kind])
    crew.max_steering_rate[:] = math.inf
    simulation = Simulation([world(crew, side=100.0, steps=100)])
    twist = np.ones((1, 1), bool)
    made = [simulation.step(np.array([[command]]), twist) for command in twists]
    for executed in reversed(made):
        simulation.step(-executed, twist)
    np.testing.assert_allclose(simulation.position[0, 0], [50, 50], atol=1e-12)
    turned = math.remainder(float(simulation.heading[0, 0]) - heading, 2.0 * math.pi)
    assert abs(turned) < 1e-12


@pytest.mark.parametrize(("substeps", "rate"), [(1, 2.5), (2, 2.5), (4, 1.0)])
def test_the_error_of_an_arc_is_within_its_bound(substeps, rate):
    """Position after a drive of length s: at most s (w h)² / 24 beside the exact arc."""
    crew = agents([50, 50], [90, 90], unicycle=1, speed=1.0)
    simulation = Simulation([world(crew, side=100.0, steps=50, substeps=substeps)])
    for _ in range(40):
        simulation.step(np.array([[[1.0, rate]]]), np.ones((1, 1), bool))
    angle, radius = rate * 40 * DT, 1.0 / rate
    exact = [50 + radius * math.sin(angle), 50 + radius * (1 - math.cos(angle))]
    bound = 40 * DT * (rate * DT / substeps) ** 2 / 24
    away = np.hypot(*(simulation.position[0, 0] - exact))
    assert 0.0 < away <= bound


def driven(worlds, order):
    simulation = Simulation([worlds[k] for k in order])
    rngs = [np.random.default_rng(k) for k in order]
    twist = np.zeros((len(order), simulation.A), bool)
    for _ in range(40):
        command = np.array([rng.normal(size=(simulation.A, 2)) * 2 for rng in rngs])
        simulation.step(command, twist)
    return {k: simulation.position[b].tobytes() for b, k in enumerate(order)}


@pytest.mark.parametrize("threads", ["1", "3"])
def test_bits_depend_neither_on_the_batch_nor_on_threads(threads, monkeypatch):
    worlds = [*(limited_world(seed, steps=40) for seed in range(4)), random_world(9, steps=40)]
    expected = {k: driven(worlds, [k])[k] for k in range(5)}
    monkeypatch.setenv("BENCHNAV_THREADS", threads)
    assert driven(worlds, [4, 2, 0, 3, 1, 2]) == expected


def test_a_row_that_starts_again_starts_at_rest_with_its_wheels_straight():
    pool = [limited_world(seed, steps=40) for seed in range(2)]
    again, fresh = AutoresetSimulation(pool, 2), Simulation(pool[::-1])
    rng = np.random.default_rng(0)
    commands, twist = rng.normal(size=(12, 2, 4, 2)) * 2, np.zeros((2, 4), bool)
    for command in commands:
        again.step(command, twist)
    again.restart(np.arange(2), np.array([1, 0]))
    for command in commands:
        executed = again.step(command, twist)
        np.testing.assert_array_equal(executed, fresh.step(command, twist))
    np.testing.assert_array_equal(again.position, fresh.position)
