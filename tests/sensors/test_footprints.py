"""Rays that hit bodies that are not discs, and neighbours that report their shapes."""

import math
from dataclasses import replace

import numpy as np
import pytest

from benchnav.arena.noise import Noise
from benchnav.arena.sensing import NeighbourSensor, RaySensor, Sensing
from benchnav.arena.solid import Kind
from benchnav.isolation.observation_codec import decode_observation, encode_observation
from benchnav.navigation.observation import Observation
from benchnav.sensors.noise.noisy_senses import NoisySenses
from benchnav.sensors.sense import sense
from benchnav.world.simulation import Simulation
from tests import worlds
from tests.world.test_footprint import SHAPES, core, shaped

SENSORS = Sensing(
    RaySensor(24, 2.0 * math.pi, 6.0, thick=True), NeighbourSensor(4, 8.0), None, occlusion=False
)


def scene(seed, rays=SENSORS.rays):
    """Return a simulation of a long agent among others, of which the last is a disc."""
    rng = np.random.default_rng(seed)
    start = np.array([[10.0, 10.0], [13.0, 10.5], [9.0, 13.0], [7.5, 8.0]]) + rng.normal(
        0, 0.2, (4, 2)
    )
    crew = worlds.agents(start, start, 0.5, heading=rng.uniform(-3, 3, 4))
    shapes = [SHAPES[k] for k in rng.integers(3, size=3)] + [(0.0, 0.0, 0.0)]
    crew = shaped(crew, shapes)
    crew = replace(crew, radius=np.where(crew.rounding > 0.0, crew.radius, 0.5))
    return Simulation([worlds.world(crew, sensing=replace(SENSORS, rays=rays))])


def first_hit(simulation, angle, reach):
    """Return the first distance at which the circle within the body meets another, by bisection."""
    agents = simulation.worlds[0].agents
    place, heading = simulation.position[0], simulation.heading[0]
    way = np.array([math.cos(angle), math.sin(angle)])
    found = 6.0
    for j in range(1, 4):
        shape, margin = core(agents, j, place[j], heading[j])

        def gap(t, shape=shape, margin=margin):
            import shapely

            return shape.distance(shapely.Point(place[0] + t * way)) - margin - reach

        times = np.linspace(0.0, 6.0, 1201)
        inside = np.flatnonzero([gap(t) <= 0.0 for t in times])
        if len(inside) and inside[0] > 0:
            low, high = times[inside[0] - 1], times[inside[0]]
            for _ in range(50):
                middle = 0.5 * (low + high)
                low, high = (low, middle) if gap(middle) <= 0.0 else (middle, high)
            found = min(found, high)
    return found


@pytest.mark.parametrize("circumscribed", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_thick_rays_are_casts_of_a_circle_against_footprints(seed, circumscribed):
    simulation = scene(seed, replace(SENSORS.rays, circumscribed=circumscribed))
    rays, _, _ = sense(simulation, np.zeros((1, 1), np.int64), frozenset({"rays"}))
    agents = simulation.worlds[0].agents
    own = (agents.radius if circumscribed else agents.inner_radius)[0]
    assert rays.radius == own
    hits = 0
    for r, angle in enumerate(rays.angle):
        expected = first_hit(simulation, simulation.heading[0, 0] + angle, own)
        if expected == 6.0 and rays.distance[0, 0, r] > 5.5:
            continue  # a graze between two samples
        assert rays.distance[0, 0, r] == pytest.approx(expected, abs=1e-6)
        hits += rays.kind[0, 0, r] == int(Kind.AGENT)
    assert hits >= 3


@pytest.mark.parametrize(
    ("sensor", "own"),
    [
        (SENSORS.rays, "inner_radius"),
        (replace(SENSORS.rays, circumscribed=True), "radius"),
        (replace(SENSORS.rays, thick=False), None),
    ],
)
def test_the_goal_on_noisy_rays_is_met_by_the_circle_that_is_cast(sensor, own):
    simulation = scene(2, sensor)
    simulation.agents["goal_x"] += 2.0
    exact = sense(simulation, np.arange(4)[None], frozenset({"rays"}))[0]
    senses = NoisySenses(simulation, np.arange(4)[None], Noise())
    senses.begin(np.zeros(1, np.int64), np.array([[1, 2]], np.uint64))
    noisy = senses.sense(np.ones((1, 4), bool), frozenset({"rays"}))[0]
    assert np.isfinite(exact.goal).any()
    for name in ("distance", "goal", "radius"):
        assert (getattr(noisy, name) == getattr(exact, name)).all()
    agents = simulation.worlds[0].agents
    assert (exact.radius[0] == (getattr(agents, own) if own else 0.0)).all()


def test_neighbours_report_shapes_also_through_the_wire():
    simulation = scene(1)
    _, seen, _ = sense(simulation, np.zeros((1, 1), np.int64), frozenset({"neighbours"}))
    agents = simulation.worlds[0].agents
    for k in range(3):
        place = seen.position[0, 0, k]
        a = int(np.argmin(np.hypot(*(simulation.position[0] - place).T)))
        assert seen.radius[0, 0, k] == agents.radius[a]
        for name in ("half_length", "half_width", "rounding"):
            assert getattr(seen, name)[0, 0, k] == pytest.approx(getattr(agents, name)[a])
        assert seen.heading[0, 0, k] == (simulation.heading[0, a] if a < 3 else 0.0)
    assert not seen.rounding[0, 0, 3:].any()
    own = np.zeros((1, 1, 2))
    observation = Observation(
        rows=np.zeros(1, np.int64), time=np.zeros(1), active=np.ones((1, 1), bool), position=own,
        heading=own[..., 0], velocity=own, goal=own, maps=(None,), neighbours=seen,
    )  # fmt: skip
    again = decode_observation(encode_observation(observation, ()), {0: None}).neighbours
    for name in ("heading", "half_length", "half_width", "rounding", "radius"):
        assert (getattr(again, name) == getattr(seen, name)).all()


def test_shapes_of_discs_are_not_sent():
    simulation = Simulation([worlds.random_world(1, sensing=SENSORS)])
    _, seen, _ = sense(simulation, np.zeros((1, 1), np.int64), frozenset({"neighbours"}))
    own = np.zeros((1, 1, 2))
    observation = Observation(
        rows=np.zeros(1, np.int64), time=np.zeros(1), active=np.ones((1, 1), bool), position=own,
        heading=own[..., 0], velocity=own, goal=own, maps=(None,), neighbours=seen,
    )  # fmt: skip
    fields = encode_observation(observation, ())
    assert "neighbours.rounding" not in fields
    assert not decode_observation(fields, {0: None}).neighbours.rounding.any()
