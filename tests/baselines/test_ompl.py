"""What every OMPL planner promises, on small maps of our own."""

import subprocess
import sys
import textwrap

import numpy as np
import pytest
from pydantic import ValidationError

from benchnav.arena.solid import Kind, Solid
from benchnav.geometry.geodesic import FreeSpace
from benchnav.geometry.sweep import motion_is_free
from benchnav.navigation.map import Map
from benchnav.navigation.planner import Plan
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import PLANNERS

pytest.importorskip("ompl")
NAMES = [name for name in PLANNERS.names() if name.startswith("ompl.")]
RADIUS, TOLERANCE = 0.3, 0.3
START, GOAL = np.array([1.0, 1.0]), np.array([19.0, 19.0])


def box(x: float, y: float, w: float, h: float) -> np.ndarray:
    return np.array([(x, y), (x + w, y), (x + w, y + h), (x, y + h)])


def block(*at: float) -> Solid:
    return Solid(Kind.STATIC, (box(*at),))


def arena(*solids: Solid, side: float = 20.0) -> Map:
    wall = Solid(Kind.WALL, (box(0.0, 0.0, side, side)[::-1].copy(),))
    return Map((0.0, 0.0, side, side), (wall, *solids))


def furnished(seed: int) -> Map:
    places = np.random.default_rng(seed).uniform(3.0, 16.0, (10, 2))
    return arena(block(9.0, 9.0, 2.0, 2.0), *(block(*place, 1.0, 1.0) for place in places))


def plan(planner, map: Map, start=START, goal=GOAL, seed: int = 0, radius: float = RADIUS) -> Plan:
    if isinstance(planner, str | dict):
        planner = make(PLANNERS, planner)
    rng = np.random.default_rng(seed)
    return planner.plan(map, np.array(start), np.array(goal), radius, TOLERANCE, rng)


def assert_valid(found: Plan, map: Map, start=START, goal=GOAL, radius: float = RADIUS) -> None:
    assert found.solved, found.reason
    assert np.isfinite(found.path).all()
    assert found.path.shape[1] == 2
    np.testing.assert_array_equal(found.path[0], start)
    assert np.hypot(*(found.path[-1] - goal)) <= TOLERANCE
    for p, q in zip(found.path[:-1], found.path[1:], strict=True):
        assert motion_is_free(*p, *q, radius - 1.1e-6, map.capsules)


@pytest.mark.parametrize("name", NAMES)
def test_paths_are_free_near_the_shortest_and_the_same_for_the_same_generator(name):
    planner = make(PLANNERS, name)
    for seed in range(4):
        map = furnished(seed)
        found = plan(planner, map, seed=seed)
        assert_valid(found, map)
        shortest = FreeSpace(map.capsules, RADIUS).length(START, GOAL)
        assert shortest - 1e-4 <= found.length <= 1.3 * shortest
        for other in (planner, make(PLANNERS, name)):
            again = plan(other, furnished(seed), seed=seed)
            np.testing.assert_array_equal(found.path, again.path)
            assert again.checks == found.checks


@pytest.mark.parametrize("name", NAMES)
def test_nothing_but_the_generator_decides(name):
    map = furnished(1)
    found = plan({"type": name, "simplify": False}, map)
    plan(name, furnished(2), seed=5)  # another query in between
    np.random.seed(3)  # noqa: NPY002  the global generator must not matter
    np.testing.assert_array_equal(
        found.path, plan({"type": name, "simplify": False}, furnished(1)).path
    )
    shared = {"shared": False} if name == "ompl.prm" else {}
    spec = {"type": name, "simplify": False, **shared}
    paths = [plan(spec, map, seed=seed).path for seed in range(3)]
    assert len({path.tobytes() for path in paths}) > 1


@pytest.mark.parametrize("name", NAMES)
def test_a_free_straight_motion_is_the_answer(name):
    found = plan(name, arena())
    np.testing.assert_array_equal(found.path, [START, GOAL])
    assert found.checks == 1


@pytest.mark.parametrize("name", NAMES)
def test_what_has_no_answer_is_a_result_with_its_reason(name):
    spec = {"type": name, "iterations": 50}
    spec |= {"doublings": 1} if name == "ompl.prm" else {}
    walled = arena(block(0.0, 9.0, 20.0, 1.0))
    for start, goal, reason in (
        (START, GOAL, "no path was found within the budget"),
        ((5.0, 9.5), GOAL, "the start is blocked"),
        ((5.0, 8.8), GOAL, "the start is blocked"),
        (START, (5.0, 9.5), "the goal is blocked"),
        (START, (30.0, 30.0), "the goal is blocked"),
        ((np.nan, 1.0), GOAL, "start, goal, radius or tolerance is not finite"),
    ):
        found = plan(spec, walled, start, goal)
        assert (found.solved, found.reason, found.path.shape) == (False, reason, (0, 2))


@pytest.mark.parametrize("name", NAMES)
def test_it_squeezes_through_what_leaves_no_clearance(name):
    map = arena(block(0.0, 4.0, 5.0, 1.0), block(6.0, 4.0, 4.0, 1.0), side=10.0)
    spec = {"type": name, "clearance": 0.25}
    spec |= {"doublings": 2} if name == "ompl.prm" else {"iterations": 3000}
    found = plan(spec, map, (2.0, 1.0), (2.0, 8.0))
    assert_valid(found, map, (2.0, 1.0), (2.0, 8.0))


def test_clearance_is_kept_where_there_is_room():
    map = furnished(0)
    found = plan("ompl.rrt-connect", map)
    for p, q in zip(found.path[:-1], found.path[1:], strict=True):
        assert motion_is_free(*p, *q, RADIUS + 0.05 - 1.1e-6, map.capsules)


@pytest.mark.parametrize("gap", [0.0, -5e-7, 0.01, 0.03, 0.06])
def test_an_agent_may_start_and_end_in_contact(gap):
    map = arena(block(9.0, 9.0, 2.0, 2.0))
    start, goal = np.array([9.0 - RADIUS - gap, 10.0]), np.array([11.0 + RADIUS + gap, 10.0])
    found = plan("ompl.rrt-connect", map, start, goal)
    assert_valid(found, map, start, goal)


def test_a_blocked_goal_ends_beside_it_within_the_tolerance():
    map = arena(block(9.0, 9.0, 2.0, 2.0))
    goal = np.array([9.0 - RADIUS + 0.2, 10.0])
    found = plan("ompl.rrt-connect", map, START, goal)
    assert_valid(found, map, START, goal)
    assert not np.array_equal(found.path[-1], goal)


def test_start_at_the_goal_is_a_path_of_length_zero():
    assert plan("ompl.rrt-connect", arena(), START, START).length == 0.0


def test_simplifying_never_makes_a_path_longer_and_mostly_makes_it_shorter():
    shorter = 0
    for seed in range(8):
        map = furnished(seed)
        plain = plan({"type": "ompl.rrt-connect", "simplify": False}, map)
        simple = plan("ompl.rrt-connect", map)
        assert simple.length <= plain.length + 1e-9
        shorter += simple.length < 0.99 * plain.length
    assert shorter >= 4


def test_a_roadmap_does_not_depend_on_who_asks_first():
    spec = {"type": "ompl.prm", "simplify": False}
    queries = [(START, GOAL), (np.array([19.0, 1.0]), np.array([1.0, 19.0]))]
    map, other = furnished(3), furnished(3)
    forward, backward = make(PLANNERS, spec), make(PLANNERS, spec)
    one = [plan(forward, map, *query, seed=1) for query in queries]
    two = [plan(backward, other, *query, seed=2) for query in queries[::-1]][::-1]
    for a, b in zip(one, two, strict=True):
        np.testing.assert_array_equal(a.path, b.path)


def test_a_wall_clock_budget_is_declared_irreproducible_and_ends():
    planner = make(PLANNERS, {"type": "ompl.rrt-star", "seconds": 0.05, "iterations": 10**9})
    assert not planner.reproducible
    assert make(PLANNERS, "ompl.rrt-star").reproducible
    assert not plan(planner, arena(block(0.0, 9.0, 20.0, 1.0))).solved


@pytest.mark.parametrize("change", [{"iterations": 0}, {"seconds": 0.0}, {"clearance": -1.0}])
def test_impossible_parameters_are_refused(change):
    for name in NAMES:
        with pytest.raises(ValidationError):
            PLANNERS.load(name).Config(**change)


def test_a_process_that_plans_says_nothing_and_ends():
    program = f"""
        import numpy as np
        from benchnav.arena.solid import Kind, Solid
        from benchnav.navigation.plugin.configure import make
        from benchnav.navigation.map import Map
        from benchnav.plugins import PLANNERS
        square = np.array([(4.0, 4.0), (6.0, 4.0), (6.0, 6.0), (4.0, 6.0)])
        map = Map((0.0, 0.0, 10.0, 10.0), (Solid(Kind.STATIC, (square,)),))
        planners = [make(PLANNERS, name) for name in {NAMES}]
        for planner in planners:
            for seed in range(2):
                rng = np.random.default_rng(seed)
                ends = np.array([1.0, 1.0]), np.array([9.0, 9.0])
                assert planner.plan(map, *ends, 0.3, 0.3, rng).solved
    """
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", textwrap.dedent(program)],
        capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
