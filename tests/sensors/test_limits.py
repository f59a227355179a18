"""Sensors where there is much of everything, and at the ends of their range."""

import math

import numpy as np
import pytest

from benchnav.arena.sensing import EdgeSensor, NeighbourSensor, RaySensor, Sensing
from benchnav.arena.solid import Kind, Solid
from benchnav.sensors.sense import sense
from benchnav.sensors.sight import (
    TABLE,
    _clear_along,
    _clear_of_discs,
    _clear_of_edges,
    copy_fixed,
    hides,
    list_blockers,
    stand_at,
)
from benchnav.world.simulation import Simulation
from tests.worlds import agents, back_and_forth, box, disc, walls, world


def first_agent(simulation, *needs):
    chosen = np.full((1, simulation.A), -1)
    chosen[0, 0] = 0
    return sense(simulation, chosen, frozenset(needs))


def test_a_crowd_behind_hides_no_wall_ahead():
    rng = np.random.default_rng(0)
    behind = np.column_stack([rng.uniform(1.0, 9.0, 700), rng.uniform(1.0, 19.0, 700)])
    start = np.vstack([[10.0, 10.0], behind])
    wall = box(Kind.WALL, 13.0, 10.0, 0.1, 5.0)
    crew = agents(start, start + 1.0, radius=0.05)
    rays, _, _ = first_agent(Simulation([world(crew, [wall])]), "rays")
    assert rays.kind[0, 0, 3] == Kind.WALL
    assert rays.distance[0, 0, 3] == pytest.approx(2.9 - 0.05)


def test_a_pillar_is_seen_in_a_small_world_and_in_a_large_one():
    pillar = disc(Kind.STATIC, 10.0, 10.0, 3.0)
    posts = [disc(Kind.STATIC, 18.5, 0.2 * k + 1.0, 0.05) for k in range(80)]
    sensing = Sensing(None, None, EdgeSensor(8, 1.0))
    crew = agents([6.5, 10.0], [1.0, 1.0], radius=0.3)
    few = first_agent(Simulation([world(crew, [pillar], sensing=sensing)]), "edges")[2]
    many = first_agent(Simulation([world(crew, [pillar, *posts], sensing=sensing)]), "edges")[2]
    assert few.count[0, 0] == many.count[0, 0] > 0
    np.testing.assert_array_equal(few.start[0, 0], many.start[0, 0])


@pytest.mark.parametrize("count", [3, 100])
def test_whoever_is_in_sight_is_sensed_behind_any_number_of_hidden(count):
    """96 agents behind a wall are nearer than the two that can be seen."""
    rng = np.random.default_rng(1)
    hidden = np.column_stack([rng.uniform(11.0, 12.0, 96), rng.uniform(9.0, 11.0, 96)])
    seen = [[6.0, 10.0], [5.0, 10.0]]
    crew = agents(np.vstack([[10.0, 10.0], hidden, seen]), np.ones((99, 2)), radius=0.01)
    wall = box(Kind.WALL, 10.5, 10.0, 0.1, 5.0)
    sensing = Sensing(None, NeighbourSensor(count, 8.0), None)
    neighbours = first_agent(Simulation([world(crew, [wall], sensing=sensing)]), "neighbours")[1]
    assert neighbours.count[0, 0] == 2
    np.testing.assert_array_equal(neighbours.position[0, 0, :2], seen)


def test_as_many_neighbours_as_were_asked_for():
    rng = np.random.default_rng(2)
    crew = agents(rng.uniform(9, 11, (120, 2)), np.ones((120, 2)), radius=0.01)
    for occlusion in (True, False):
        sensing = Sensing(None, NeighbourSensor(100, 8.0), None, occlusion)
        simulation = Simulation([world(crew, [walls(20.0)], sensing=sensing)])
        assert first_agent(simulation, "neighbours")[1].count[0, 0] == 100


def test_lines_of_sight_do_not_leak_through_small_things():
    """The walk over the grid and the test of everything agree on thousands of lines."""
    rng = np.random.default_rng(3)
    places = rng.uniform(1.0, 59.0, (150, 2))
    things = [box(Kind.STATIC, *p, 0.02, 0.02, rng.uniform(0, 3)) for p in places]
    crew = agents([30.0, 30.0], [1.0, 1.0], radius=0.05)
    simulation = Simulation([world(crew, things, side=60.0)])
    s, row, cut = simulation, simulation.records[0], 0
    for _ in range(6000):
        aim = places[rng.integers(150)] + rng.normal(0, 0.02, 2)
        p = rng.uniform(0.0, 60.0, 2)
        q = p + (aim - p) * rng.uniform(0.9, 1.5)
        plain = not any(hides(capsule, *p, *q) for capsule in s.capsules)
        assert _clear_along(*p, *q, row, s.capsules, s.start, s.item) == plain
        cut += not plain
    assert 1000 < cut < 5900


def test_a_table_of_few_capsules_hides_the_same_points():
    """Edges and discs of worlds of several sizes, one after another in the same table."""
    rng, table, cut = np.random.default_rng(4), np.full(TABLE, np.nan), 0
    crew = agents([10.0, 10.0], [1.0, 1.0], radius=0.05)
    for boxes, posts in ((12, 16), (1, 0), (3, 1), (0, 2), (0, 0), (16, 0)):
        solids = [box(Kind.WALL, *rng.uniform(1, 19, 2), 1, 0.5, 0.3 * k) for k in range(boxes)]
        solids += [disc(Kind.STATIC, *rng.uniform(1, 19, 2), 0.4) for _ in range(posts)]
        s = Simulation([world(crew, solids)])
        size, discs = copy_fixed(s.records[0], s.capsules, table)
        assert discs == (posts > 0)
        for _ in range(300):
            p, q = rng.uniform(0, 20, (2, 2)).round(rng.integers(0, 4))
            stand_at(*p, size, table)
            edges_clear = _clear_of_edges(*p, *q, size, table)
            discs_clear = _clear_of_discs(*p, *q, size, table)
            for is_disc, clear in ((False, edges_clear), (True, discs_clear)):
                some = [c for c in s.capsules if (c["r"] > 0.0) == is_disc]
                plain = not any(hides(c, *p, *q) for c in some)
                assert clear == plain
                cut += not plain
    assert cut > 500
    many = Simulation([world(crew, [disc(Kind.STATIC, 2.0, 2.0, 0.1)] * 65)])
    assert copy_fixed(many.records[0], many.capsules, table) == (-1, False)


def test_bodies_that_cannot_hide_a_point_in_range_are_left_out():
    carts = [back_and_forth(box(Kind.DYNAMIC, 0, 0, 1, 1), [x, 5], [x, 9], 1.0) for x in (8, 13)]
    s = Simulation([world(agents([5.0, 5.0], [1.0, 1.0]), bodies=carts)])
    blockers = np.full(2, -1)
    assert list_blockers(s.agents[0, 0], 4.0, 2, s.bodies[0], blockers) == 1
    assert blockers.tolist() == [0, -1]
    assert list_blockers(s.agents[0, 0], 8.0, 2, s.bodies[0], blockers) == 2


def test_a_wide_agent_at_the_rim_of_the_range_is_met():
    """Its centre is farther away than the range and the own radius; its rim is not."""
    start = np.vstack([[5.0, 10.0], [5.0 + 1.80 + 0.05 + 0.25, 10.0], np.full((30, 2), 18.0)])
    radius = np.array([0.05, 0.25, *np.full(30, 0.05)])
    sensing = Sensing(RaySensor(7, math.pi, 1.81, thick=True), None, None)
    rays = first_agent(Simulation([world(agents(start, start, radius), sensing=sensing)]), "rays")[
        0
    ]
    assert rays.kind[0, 0, 3] == Kind.AGENT
    assert rays.distance[0, 0, 3] == pytest.approx(1.80)


def test_an_edge_is_told_only_as_far_as_the_sensor_reaches():
    """A long wall's end, and what lies behind it, stay unknown."""
    loop = np.array([[2.0, 5.0], [2.0, 4.0], [18.0, 4.0], [18.0, 5.0]])
    sensing = Sensing(None, None, EdgeSensor(8, 3.0))
    crew = agents([3.0, 6.0], [1.0, 1.0], radius=0.2)
    simulation = Simulation([world(crew, [Solid(Kind.WALL, (loop,))], sensing=sensing)])
    edges = first_agent(simulation, "edges")[2]
    assert edges.count[0, 0] == 1
    # the top runs from (18, 5) to (2, 5); the agent is 1 m above it
    np.testing.assert_allclose(edges.start[0, 0, 0], [3.0 + math.sqrt(8.0), 5.0])
    np.testing.assert_allclose(edges.end[0, 0, 0], [2.0, 5.0])
    np.testing.assert_allclose(edges.before[0, 0, 0], [-1.0, 0.0])  # as if it went on
    np.testing.assert_allclose(edges.after[0, 0, 0], [0.0, -1.0])  # a corner within reach
    assert np.hypot(*(edges.start[0, 0, 0] - [3.0, 6.0])) <= 3.0 + 1e-12
