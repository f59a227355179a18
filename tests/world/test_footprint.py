"""Bodies that are not discs: contacts while they move and turn, against shapely."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity

from benchnav.arena.solid import Kind
from benchnav.arena.world import Afterwards, ContactRule
from benchnav.episode.episode import Status
from benchnav.world.simulation import Simulation
from tests import worlds

DEEPEST = 1e-8  # [m] allowed overlap with anything that yields or stands: rounding


def shaped(crew, shapes):
    """Return the crew with footprints (A, 3): half length, half width, rounding [m]."""
    length, width, corner = np.broadcast_to(np.asarray(shapes, float), (len(crew), 3)).T
    radius = np.hypot(length - corner, width - corner) + corner
    return replace(crew, radius=radius, half_length=length, half_width=width, rounding=corner)


def core(agents, i, position, heading):
    """Return (core of agent i as a shape of shapely, radius [m] around it)."""
    if agents.rounding[i] == 0.0:
        return shapely.Point(position), agents.radius[i]
    x = agents.half_length[i] - agents.rounding[i]
    y = agents.half_width[i] - agents.rounding[i]
    box = shapely.MultiPoint([(-x, -y), (x, -y), (x, y), (-x, y)]).convex_hull
    turned = affinity.rotate(box, heading, origin=(0, 0), use_radians=True)
    return affinity.translate(turned, *position), agents.rounding[i]


def fixed_core(solid):
    if solid.is_disc:
        return shapely.Point(solid.center), solid.radius
    return shapely.MultiLineString([[*loop, loop[0]] for loop in solid.loops]), 0.0


def deepest(world, simulation, b=0):
    """Return the deepest overlap [m] of agents with each other and with fixed solids.

    It is exact up to the depth at which cores meet.
    """
    present = np.flatnonzero(simulation.present[b])
    cores = {
        i: core(world.agents, i, simulation.position[b, i], simulation.heading[b, i])
        for i in present
    }
    fixed = [fixed_core(solid) for solid in world.solids]
    worst = -math.inf
    for i in present:
        shape, radius = cores[i]
        for other, reach in [*(cores[j] for j in present if j > i), *fixed]:
            worst = max(worst, radius + reach - shape.distance(other))
    return worst


SHAPES = [(0.6, 0.2, 0.2), (0.5, 0.4, 0.05), (0.3, 0.45, 0.1), (0.4, 0.4, 0.4), (0.8, 0.1, 0.1)]


def crowded(seed, count=4, contact=ContactRule.SLIDE, **options):
    """Return a small walled world, full of boxes, discs and long bodies."""
    rng = np.random.default_rng(seed)
    base = worlds.random_world(seed, count, radius=0.85, contact=contact, **options)
    shapes = [SHAPES[k] for k in rng.integers(len(SHAPES), size=count)]
    return replace(base, agents=shaped(base.agents, shapes), bodies=())


def drive(simulation, rng, steps, twist=None):
    """Yield after each of some steps with random commands that last a while."""
    shape = simulation.position.shape
    for t in range(steps):
        if t % 6 == 0:
            command = rng.normal(0.0, 2.0, shape)
            twisted = rng.random(shape[:2]) < 0.5 if twist is None else np.full(shape[:2], twist)
            command[twisted] = np.abs(command[twisted]) * [1.0, 1.0]
            command[..., 1] *= np.where(twisted, rng.choice([-1.0, 1.0], shape[:2]), 1.0)
        simulation.step(command, twisted)
        yield t


@pytest.mark.parametrize("rule", list(ContactRule))
@settings(max_examples=12, deadline=None)
@given(st.integers(0, 10**6), st.booleans())
def test_no_body_penetrates_whatever_the_commands(rule, seed, unicycle):
    world = crowded(seed, 5, rule, unicycle=unicycle, side=20.0, on_end=Afterwards.STAY)
    simulation = Simulation([world])
    assert deepest(world, simulation) <= 0.0
    for _ in drive(simulation, np.random.default_rng(seed), 40):
        assert deepest(world, simulation) < DEEPEST
