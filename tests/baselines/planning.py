"""Maps and queries that planners are tried on, and what holds for every answer."""

from functools import lru_cache
from pathlib import Path

import numpy as np

import benchnav
from benchnav.arena.solid import Kind, Solid
from benchnav.generation.build import build
from benchnav.geometry.geodesic import FreeSpace
from benchnav.geometry.sweep import inside_solid, motion_is_free, solid_index
from benchnav.navigation.map import Map
from benchnav.navigation.planner import Plan
from benchnav.navigation.plugin.configure import make
from benchnav.navigation.tracks import granted_map
from benchnav.plugins import PLANNERS
from benchnav.scenario.load import load_scenario

RADIUS, TOLERANCE = 0.3, 0.3
START, GOAL = np.array([1.0, 1.0]), np.array([19.0, 19.0])
SCENARIOS = ("leaders/static", "maze/grid", "office/rooms", "trap/u")
SKIN = 1.1e-6  # [m] by which a path may cut into what it touches


def box(x, y, w, h):
    return np.array([(x, y), (x + w, y), (x + w, y + h), (x, y + h)])


def block(*at):
    return Solid(Kind.STATIC, (box(*at),))


def disc(x, y, radius):
    return Solid(Kind.STATIC, center=(x, y), radius=radius)


def arena(*solids, side=20.0):
    wall = Solid(Kind.WALL, (box(0.0, 0.0, side, side)[::-1].copy(),))
    return Map((0.0, 0.0, side, side), (wall, *solids))


def furnished(seed):
    """Blocks, some of which overlap, discs and a thin wall in a walled square."""
    rng = np.random.default_rng(seed)
    blocks = [block(*place, *rng.uniform(0.5, 3.0, 2)) for place in rng.uniform(3, 15, (8, 2))]
    discs = [disc(*place, rng.uniform(0.2, 1.0)) for place in rng.uniform(3, 17, (4, 2))]
    thin = Solid(Kind.WALL, (np.array([(9.0, 4.0), (9.5, 12.0)]),))
    return arena(*blocks, *discs, thin)


@lru_cache
def drawn(name, seeds=2):
    """[(map, start, goal, radius, tolerance)] of all agents of a scenario's validation worlds."""
    scenario = load_scenario(Path(benchnav.__file__).parents[1] / "scenarios" / f"{name}.yaml")
    queries = []
    for seed in range(seeds):
        world = build(scenario, "validation", seed)
        map, agents = granted_map(world, "known"), world.agents
        queries += [
            (map, agents.start[a], agents.goal[a], float(agents.radius[a]), 0.0)
            for a in range(len(agents.radius))
        ]
    return queries


def plan(planner, map, start=START, goal=GOAL, radius=RADIUS, tolerance=TOLERANCE, seed=0):
    if isinstance(planner, str | dict):
        planner = make(PLANNERS, planner)
    rng = np.random.default_rng(seed)
    found = planner.plan(map, np.array(start), np.array(goal), radius, tolerance, rng)
    assert isinstance(found, Plan)
    return found


def assert_valid(found, map, start=START, goal=GOAL, radius=RADIUS, tolerance=TOLERANCE):
    assert found.solved, found.reason
    assert np.isfinite(found.path).all()
    assert found.path.shape[1] == 2
    np.testing.assert_array_equal(found.path[0], start)
    assert np.hypot(*(found.path[-1] - goal)) <= tolerance
    assert not inside_solid(*start, map.capsules, *solid_index(map.solids))
    for p, q in zip(found.path[:-1], found.path[1:], strict=True):
        assert motion_is_free(*p, *q, max(radius - SKIN, 0.0), map.capsules)


@lru_cache(maxsize=64)
def space(map, radius):
    return FreeSpace(map.capsules, radius)


def excess(found, map, start=START, goal=GOAL, radius=RADIUS):
    """By which share a path is longer than the exact shortest one."""
    return found.length / space(map, radius).length(start, goal) - 1.0


def moved(map, angle, shift):
    """(the map turned about the origin and shifted, what does that to points (…, 2))."""
    c, s = np.cos(angle), np.sin(angle)

    def move(points):
        return np.asarray(points) @ np.array([[c, s], [-s, c]]) + shift

    solids = tuple(
        Solid(o.kind, center=tuple(move(o.center).tolist()), radius=o.radius)
        if o.is_disc
        else Solid(o.kind, tuple(move(loop) for loop in o.loops))
        for o in map.solids
    )
    x0, y0, x1, y1 = map.bounds
    corners = move(np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]))
    bounds = (*corners.min(axis=0).tolist(), *corners.max(axis=0).tolist())
    return Map(bounds, solids), move
