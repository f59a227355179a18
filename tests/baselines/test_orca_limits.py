"""ORCA for bodies that cannot take a velocity at once: NH-ORCA, cars, limits of acceleration."""

import math
from dataclasses import replace

import numpy as np
import pytest
from benchnav_baselines.common.motion_limits import limits_of
from benchnav_baselines.controllers.orca.navigator import Orca
from benchnav_baselines.controllers.orca.trackable import MOST, trackable, tracking_error

from benchnav.arena.agents import Dynamics
from benchnav.world.motion_limits import limit_records
from tests.baselines.crowds import answers, briefing, one_world
from tests.baselines.test_body_limits import BODIES, bodies, executed

FINE = 0.02  # [s] between decisions: the bounds are of continuous time
ERROR = 0.1  # [m]


def body(name, **changes):
    columns = {**BODIES[name], **changes}
    return replace(bodies(briefing([(0, 0)], [(9, 0)]), **columns), dt=FINE)


def planes_of(told, velocity, course=0.0):
    planes = np.full((MOST, 4), np.nan)
    n = trackable(limits_of(told)[0], course, *velocity, ERROR, planes)
    assert np.isfinite(planes[:n]).all()
    return planes[:n]


def permits(planes, x, y):
    return (planes[:, 2] * (y - planes[:, 1]) - planes[:, 3] * (x - planes[:, 0]) >= -1e-9).all()


def strayed(told, start, wanted, time=4.0):
    """How far [m] a body that starts at speed ``start`` strays from a body that takes ``wanted``.

    After it has once come to track the velocity, it strays by a constant distance.
    """
    records, heading, place, worst = limit_records(told), 0.0, np.zeros(2), 0.0
    holonomic = told.dynamics[0] == Dynamics.HOLONOMIC
    drive = np.array([start, 0.0])
    for k in range(round(time / FINE)):
        drive = np.array(executed(*wanted, False, heading, *drive, records, 0, FINE))
        velocity = drive
        if not holonomic:
            middle = heading + 0.5 * drive[1] * FINE
            velocity = drive[0] * np.array([math.cos(middle), math.sin(middle)])
            heading += drive[1] * FINE
        place = place + FINE * velocity
        worst = max(worst, np.hypot(*(place - (k + 1) * FINE * np.array(wanted))))
    return worst


@pytest.mark.parametrize("name", ["holonomic", "wheels", "car"])
def test_permitted_velocities_are_tracked_within_the_error(name):
    """From a steady motion straight ahead. The bounds neglect that limits act together."""
    told = body(name)
    if name == "car":
        none = np.array([np.inf])
        told = replace(told, max_acceleration=none, max_deceleration=none)
    start = 0.6
    planes = planes_of(told, (start, 0.0))
    rng = np.random.default_rng(1)
    kept, refused = [], []
    for _ in range(300):
        angle, speed = rng.uniform(-math.pi, math.pi), 0.9 * math.sqrt(rng.random())
        if name == "car":  # it cannot be slower than it is told on a curve: steady speed
            speed = start
        wanted = speed * math.cos(angle), speed * math.sin(angle)
        (kept if permits(planes, *wanted) else refused).append(strayed(told, start, wanted))
    assert len(kept) > 15
    assert max(kept) < 1.25 * ERROR
    assert np.mean(refused) > 2.0 * ERROR


@pytest.mark.parametrize("name", BODIES)
def test_standing_bodies_may_stand(name):
    for course in (0.0, 2.0):
        assert permits(planes_of(body(name), (0.0, 0.0), course), 0.0, 0.0)


@pytest.mark.parametrize("top", [0.8, 2.0, 5.0])
def test_wheels_at_their_limit_may_still_turn(top):
    told = replace(body("wheels", max_wheel_speed=np.array([top])), max_speed=np.array([top]))
    planes = planes_of(replace(told, dt=0.2), (0.0, 0.0))
    for angle in (0.2, 0.5, 1.0):
        assert permits(planes, 0.1 * math.cos(angle), 0.1 * math.sin(angle))


def test_the_disc_grows_less_near_objects():
    position, radius = np.array([[1.0, 0.0]]), np.array([0.3])
    nothing = np.zeros((0, 2))
    far = (0.0, 0.0, 0.3, position, radius, 1, nothing, nothing, 0, 0.01)
    assert tracking_error(*far, 0.15) == 0.15
    assert tracking_error(*far, 0.5) == pytest.approx(0.2)  # half of the gap of 0.4 m
    wall = np.array([[-1.0, 0.32]]), np.array([[1.0, 0.32]]), 1
    assert tracking_error(0.0, 0.0, 0.3, position, radius, 0, *wall, 0.02, 0.5) == 0.02


@pytest.mark.parametrize("name", BODIES)
def test_beside_bodies_with_limits_others_answer_as_before(name):
    told, seen = one_world(1, 6)
    usual = answers(Orca(), [told], seen)
    told, _ = one_world(1, 6)
    columns = {key: np.full(6, value) for key, value in BODIES[name].items()}
    mixed = bodies(told, **BODIES[name])
    for key in columns:
        getattr(mixed, key)[:3] = getattr(told, key)[:3]
    got = answers(Orca(), [mixed], seen)
    np.testing.assert_array_equal(got[0, :3], usual[0, :3])
    assert not np.allclose(got[0, 3:], usual[0, 3:])
    assert np.isfinite(got).all()
    assert np.hypot(*got[0].T).max() <= 1.5 + 1e-9
