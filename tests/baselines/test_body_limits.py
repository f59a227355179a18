"""Commands within the dynamics of bodies: what is requested is what the simulator executes."""

import math
from dataclasses import replace

import numpy as np
import pytest
from benchnav_baselines.common.car import car_direction
from benchnav_baselines.common.motion_limits import (
    has_limits,
    limits_of,
    reached,
    steered,
    stopping_speed,
)
from benchnav_baselines.controllers.dwa.controller import DynamicWindow
from benchnav_baselines.controllers.mppi.controller import Mppi
from benchnav_baselines.controllers.path_following import PathFollowing

from benchnav.arena.agents import Dynamics
from benchnav.kernels import kernel
from benchnav.navigation.controller import Guide
from benchnav.world.motion_limits import limit_records, within_limits
from tests.baselines.crowds import DT, briefing, one_world

SLOW = {"max_acceleration": 1.0, "max_deceleration": 1.6, "max_turn_acceleration": 3.0}
WHEELS = {
    "dynamics": Dynamics.DIFFERENTIAL_DRIVE, "track_width": 0.5, "max_wheel_speed": 0.9,
}  # fmt: skip
CAR = {
    "dynamics": Dynamics.ACKERMANN, "wheelbase": 0.4, "max_steering_angle": 0.6,
    "max_steering_rate": 1.2,
}  # fmt: skip
BODIES = {
    "holonomic": SLOW,
    "unicycle": {"dynamics": Dynamics.UNICYCLE, **SLOW},
    "unicycle back": {"dynamics": Dynamics.UNICYCLE, "reverse": True, **SLOW},
    "wheels": WHEELS,
    "slow wheels": {**WHEELS, **SLOW, "reverse": True},
    "car": {**CAR, "max_acceleration": 1.0, "max_deceleration": 1.6},
    "car back": {**CAR, "reverse": True},
}


def bodies(told, **columns):
    """The briefing of the same agents with other bodies."""
    full = {name: np.full(len(told), value) for name, value in columns.items()}
    if "dynamics" in full:
        full["dynamics"] = full["dynamics"].astype(np.int8)
    return replace(told, **full)


@kernel
def executed(c0, c1, twist, heading, d0, d1, records, i, dt):
    return within_limits(c0, c1, twist, heading, d0, d1, records[i], dt)


def one_body(name, **more):
    told = briefing([(0.0, 0.0)], [(20.0, 0.0)], **more)
    return bodies(told, **BODIES[name])


def test_bodies_of_speed_and_turn_rate_have_no_further_limits():
    told = briefing([(0, 0)], [(1, 1)])
    assert not has_limits(limits_of(told)).any()
    assert not has_limits(limits_of(bodies(told, dynamics=Dynamics.UNICYCLE))).any()
    for name in BODIES:
        assert has_limits(limits_of(one_body(name))).all(), name


@pytest.mark.parametrize("name", BODIES)
def test_what_is_within_reach_is_executed_unchanged(name):
    told = one_body(name)
    limits, records = limits_of(told)[0], limit_records(told)
    rng = np.random.default_rng(1)
    v, w, steering, moved, asked = 0.0, 0.0, 0.0, 0.0, 0
    for _ in range(400):
        if rng.random() < 0.2:
            asked = rng.uniform(-2, 2), rng.uniform(-4, 4)
        v0, w0 = v, w
        v, w = reached(limits, v0, w0, steering, *(asked or (1.0, 1.0)), DT)
        steering = steered(limits, v, w, steering)
        got = executed(v, w, True, 0.0, v0, w0, records, 0, DT)
        np.testing.assert_allclose(got, (v, w), atol=1e-9)
        assert reached(limits, v0, w0, steering, v, w, DT) == pytest.approx((v, w))
        moved += abs(v) + abs(w)
    assert moved > 50.0


@pytest.mark.parametrize("make", [DynamicWindow, Mppi])
@pytest.mark.parametrize("name", BODIES)
def test_controllers_that_sample_request_what_is_executed(make, name):
    """Targets jump about and obstacles stand around; every command must be executed as it is."""
    told, seen = one_world(2, 4)
    told = bodies(told, **BODIES[name])
    records, controller = limit_records(told), make()
    controller.reset([told], seen.rows)
    rng = np.random.default_rng(3)
    last, heading, place = np.zeros((4, 2)), np.zeros(4), seen.position[0].copy()
    total = 0.0
    for k in range(40):
        if k % 8 == 0:
            target = place + rng.normal(0, 3, (4, 2))
        forward = last[:, :1] * np.stack([np.cos(heading), np.sin(heading)], axis=1)
        now = replace(seen, position=place[None], heading=heading[None], velocity=forward[None])
        guide = Guide(target[None], np.full((1, 4), 3.0), np.ones((1, 4), bool))
        command = controller.steer(now, guide)[0]
        for i in range(4):
            got = executed(*command[i], True, heading[i], *last[i], records, i, DT)
            np.testing.assert_allclose(got, command[i], atol=1e-9)
        last = command
        place = place + DT * last[:, :1] * np.stack([np.cos(heading), np.sin(heading)], axis=1)
        heading = heading + DT * last[:, 1]
        total += np.abs(last).sum()
    assert total > 10.0


def test_from_the_stopping_speed_a_body_stops_in_time():
    rng = np.random.default_rng(4)
    for _ in range(50):
        way, brake, dt = rng.uniform(0.01, 3), rng.uniform(0.2, 5), rng.uniform(0.02, 0.5)
        v = stopping_speed(way, brake, dt)
        assert v * dt + 0.5 * v * v / brake == pytest.approx(way)
    assert stopping_speed(-0.1, 1.0, DT) == 0.0
    assert stopping_speed(0.5, math.inf, 0.1) == pytest.approx(5.0)


def driven(controller, told, target, steps, heading=0.0):
    """(steps, 4) x, y, heading and speed of one body that starts at rest in the origin."""
    records, drive, place, rows = limit_records(told), np.zeros(2), np.zeros(2), []
    twist = controller.command == "twist"
    _, seen = one_world(0, 1)
    controller.reset([told], np.array([0]))
    holonomic = told.dynamics[0] == Dynamics.HOLONOMIC
    velocity = np.zeros(2)
    for _ in range(steps):
        now = replace(
            seen, rows=np.array([0]), position=place[None, None], heading=np.array([[heading]]),
            velocity=velocity[None, None], goal=told.goal[None], neighbours=None, edges=None,
        )  # fmt: skip
        goal = np.array([[target]], float)
        left = np.array([[np.hypot(*(goal[0, 0] - place))]])
        command = controller.steer(now, Guide(goal, left, np.ones((1, 1), bool)))[0, 0]
        drive = np.array(executed(*command, twist, heading, *drive, records, 0, DT))
        velocity = drive
        if not holonomic or twist:
            middle = heading + 0.5 * drive[1] * DT
            velocity = drive[0] * np.array([math.cos(middle), math.sin(middle)])
            heading += drive[1] * DT
        place = place + DT * velocity
        rows.append((*place, heading, np.hypot(*velocity)))
    return np.array(rows)


@pytest.mark.parametrize("name", ["holonomic", "unicycle", "slow wheels", "car"])
def test_path_following_stops_at_the_end_of_its_path(name):
    run = driven(PathFollowing(), one_body(name), (3.0, 0.0), 60)
    assert run[:, 0].max() < 3.0 + 1e-6
    assert run[-1, 0] > 2.9
    assert run[:, 3].max() > 0.7


@pytest.mark.parametrize("name", ["car", "car back"])
@pytest.mark.parametrize("target", [(2.0, 2.0), (-3.0, 0.5), (0.1, 0.6), (0.0, -0.9)])
def test_a_car_comes_to_targets_beside_and_behind_it(name, target):
    run = driven(PathFollowing(), one_body(name), target, 200)
    assert np.hypot(*(run[:, :2] - target).T).min() < 0.2


def test_a_car_leaves_a_target_behind_that_it_cannot_reach_on_one_curve():
    limits = limits_of(one_body("car"))[0]
    back = limits_of(one_body("car back"))[0]
    radius = 0.4 / math.tan(0.6)
    inside = (0.0, 0.0, 0.0, 0.0, 0.1, 0.9 * radius, 1.0)
    assert car_direction(limits, *inside) == (False, 0.0)
    backwards, direction = car_direction(back, *inside)
    assert backwards
    assert math.pi < direction < 1.5 * math.pi  # its front turns left
    beyond = (0.0, 0.0, 0.0, 0.0, 0.1, 2.5 * radius, 1.0)
    assert car_direction(limits, *beyond) == (False, 1.0)
    ahead = (0.0, 0.0, 0.5, 0.0, 3.0, 3.0, 1.0)
    assert car_direction(back, *ahead) == (False, pytest.approx(0.25 * math.pi))
