import math
from functools import lru_cache

import numpy as np
import pytest
from benchnav_baselines.common.disc_planner import Query, frame_of
from benchnav_baselines.common.validity_checker import PlanarChecker
from benchnav_baselines.planners.grid.lattice import joined, lattice
from benchnav_baselines.planners.grid.planner import straightened
from benchnav_baselines.planners.grid.search import Ends, search

from benchnav.geometry.sweep import motion_is_free
from benchnav.navigation.map import Map
from benchnav.scenario.files.occupancy import trace
from benchnav.scenario.importers import movingai
from benchnav.scenario.importers.grid import Occupancy
from tests.baselines.planning import (
    GOAL,
    RADIUS,
    START,
    arena,
    assert_valid,
    block,
    drawn,
    excess,
    furnished,
    plan,
)
from tests.importers.data import published
from tests.importers.test_movingai import MAPS
from tests.reference import octile, theta_star

ASTAR = {"type": "grid.astar", "clearance": 0.0}
THETA = {"type": "grid.theta-star", "clearance": 0.0}
OCTILE = 1.0 / math.cos(math.pi / 8) - 1.0  # 8.24 %: the worst of eight directions


@lru_cache
def grid_of(seed, cell=0.5):
    map = furnished(seed)
    query = Query(map, START, GOAL, RADIUS, 0.0, PlanarChecker(map, RADIUS))
    return map, lattice(map.capsules, RADIUS, cell, frame_of(query, 2 * cell), map.bounds[:2])


def places(grid):
    ny, nx = grid.moves.shape
    return {
        (i, j): (grid.x + i * grid.cell, grid.y + j * grid.cell)
        for i in range(nx)
        for j in range(ny)
    }


def slow_moves(map, grid, radius=RADIUS - 1e-8):
    at = places(grid)

    def motion(p, q):
        return motion_is_free(*at[p], *at[q], radius, map.capsules)

    return theta_star.moves({p for p in at if motion(p, p)}, motion)


# the kernels, and their slow twins


@pytest.mark.parametrize("seed", range(2))
def test_steps_are_those_of_the_slow_twin(seed):
    map, grid = grid_of(seed)
    for (i, j), expected in slow_moves(map, grid).items():
        steps = [theta_star.STEPS[d] for d in range(8) if grid.moves[j, i] >> d & 1]
        assert [(i + di, j + dj) for di, dj in steps] == expected
    at = places(grid)
    assert all(math.isclose(x % 0.5, 0.25) for x, _ in at.values())


@pytest.mark.parametrize("rings", [1, 2])
def test_ends_are_joined_to_what_lies_around_them(rings):
    map, grid = grid_of(0)
    rng = np.random.default_rng(0)
    at, nx = places(grid), grid.moves.shape[1]
    for x, y in rng.uniform(1.0, 19.0, (50, 2)):
        near = {
            p[0] + nx * p[1]: math.dist(q, (x, y))
            for p, q in at.items()
            if max(abs(q[0] - x), abs(q[1] - y)) < rings * grid.cell
            and motion_is_free(x, y, *q, RADIUS - 1e-8, map.capsules)
        }
        found = dict(zip(*joined(grid, x, y, rings), strict=True))
        assert found == pytest.approx(near)


@pytest.mark.parametrize("any_angle", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_searches_find_what_their_slow_twins_find(seed, any_angle):
    map, grid = grid_of(seed)
    table, at, nx = slow_moves(map, grid), places(grid), grid.moves.shape[1]
    rng = np.random.default_rng(seed)

    def sight(p, q):
        return motion_is_free(*p, *q, RADIUS - 1e-8, map.capsules)

    checked = 0
    for start, goal in rng.uniform(0.4, 19.6, (30, 2, 2)):
        first, last = joined(grid, *start, 1), joined(grid, *goal, 1)
        if not len(first[0]) or not len(last[0]):
            continue
        ends = Ends(*start, *goal, *first, *last)
        path, _ = search(grid, ends, any_angle)
        near, far = (
            {(int(n) % nx, int(n) // nx): d for n, d in zip(*side, strict=True)}
            for side in (first, last)
        )
        twin = theta_star.length(
            table, at | {"start": tuple(start)}, near, far, goal, sight if any_angle else None
        )
        length = np.hypot(*np.diff(path, axis=0).T).sum() if len(path) else math.inf
        assert length == pytest.approx(twin, rel=1e-9)
        checked += len(path) > 0
    assert checked >= 10


def test_a_straightened_path_is_the_same_line():
    path = np.array([[0, 0], [1, 1], [1, 1], [2, 2], [3, 2], [4, 2], [3, 2]], float)
    assert straightened(path).tolist() == [[0, 0], [2, 2], [4, 2], [3, 2]]


# paths


@pytest.mark.parametrize(
    ("scenario", "astar", "theta"),
    [
        ("leaders/static", 0.03, 0.04),
        ("maze/grid", 0.05, 0.07),
        ("office/rooms", 0.06, 0.08),
        ("trap/u", 0.0, 0.02),
    ],
)
def test_paths_in_drawn_worlds_are_near_the_shortest(scenario, astar, theta):
    """A* exceeds by its directions and by what its cells add at corners; Theta* by the latter."""
    octile, any_angle = [], []
    for query in drawn(scenario):
        octile.append(excess(plan(ASTAR, *query), *query[:4]))
        any_angle.append(excess(plan(THETA, *query), *query[:4]))
    # a single world may have a passage that only finer cells find
    assert np.quantile(octile, 0.9) <= OCTILE + astar
    assert np.quantile(any_angle, 0.9) <= theta
    assert np.mean(any_angle) <= np.mean(octile)


def test_finer_cells_bring_any_angle_near_the_exact_path():
    map = furnished(4)
    over = [excess(plan({**THETA, "cell": cell}, map), map) for cell in (0.5, 0.25, 0.0625)]
    assert over[-1] < 0.005
    assert over[-1] < over[0]


def test_octile_paths_go_in_eight_directions_between_places():
    found = plan(ASTAR, furnished(0))
    inner = found.path[1:-1]
    assert len(inner) > 1
    turn = np.arctan2(*np.diff(inner, axis=0).T[::-1]) / (math.pi / 4)
    np.testing.assert_allclose(turn, np.round(turn), atol=1e-9)
    np.testing.assert_allclose(inner / 0.25 % 1.0, 0.5, atol=1e-9)


def test_any_angle_asks_for_sight_and_counts_it():
    map = furnished(0)
    assert plan(THETA, map).checks > plan(ASTAR, map).checks > 0


def test_cells_are_halved_where_they_miss_a_passage():
    """0.12 m of room between two walls, where no place of the first grid lies."""
    walls = block(0.0, 9.0, 10.1, 1.0), block(10.1 + 0.72, 9.0, 9.18, 1.0)
    map = arena(*walls)
    assert_valid(plan(THETA, map), map)
    found = plan({**THETA, "halvings": 0}, map)
    assert (found.solved, found.reason) == (False, "no path leads to the goal on a grid of 0.25 m")


def test_a_grid_that_is_too_large_is_refused_with_its_reason():
    found = plan({**ASTAR, "cell": 0.005}, furnished(0))
    assert found.reason == "a grid of 0.005 m has more than 4000000 places"


# MovingAI


def published_map(name):
    path = published(f"movingai/{name}.map")
    occupancy = movingai.read_map(path)
    queries = movingai.read_scen(published(f"movingai/{MAPS[name]}"), path, occupancy)
    return occupancy, queries


def assert_octile(occupancy, pairs, lengths):
    """A* on cells of the map's own is the optimum of MovingAI's rules, unless it goes straight."""
    map = Map(occupancy.bounds, trace(occupancy))
    spec, compared = {**ASTAR, "cell": 1.0, "halvings": 0}, 0
    for (start, goal), length in zip(pairs, lengths, strict=True):
        ends = occupancy.centres(*np.array([start, goal], float).T)
        found = plan(spec, map, *ends, tolerance=0.0)
        if math.isnan(length):
            assert not found.solved
            continue
        assert_valid(found, map, *ends, tolerance=0.0)
        if len(found.path) > 2:
            assert found.length == pytest.approx(length, abs=max(0.011, 1e-5 * length))
            compared += 1
        else:
            assert found.length <= length + 0.011
    return compared


def test_octile_lengths_on_a_small_map_of_our_own():
    rng = np.random.default_rng(0)
    blocked = rng.random((24, 24)) < 0.25
    occupancy = Occupancy(blocked, np.zeros_like(blocked), 1.0, (0.0, 0.0, 0.0))
    table = octile.neighbours(blocked)
    cells = list(table)
    pairs = [(cells[a], cells[b]) for a, b in rng.integers(len(cells), size=(40, 2))]
    lengths = [octile.length(table, *pair) for pair in pairs]
    assert assert_octile(occupancy, pairs, lengths) >= 20


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=[pytest.mark.slow] if n.startswith(("B", "w")) else []) for n in MAPS],
)
def test_octile_lengths_are_the_published_ones(name):
    occupancy, queries = published_map(name)
    rows = range(0, min(200, len(queries.length)), 5)
    pairs = [(queries.start[k], queries.goal[k]) for k in rows]
    assert assert_octile(occupancy, pairs, queries.length[list(rows)]) >= 5
