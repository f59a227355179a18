"""Plans on a city map of 256 × 256 m: OMPL's motions, a navigation mesh, exact geodesics.

The map is Berlin_1_256 of the MovingAI benchmarks, with its published queries, if it is in the
folder `$BENCHNAV_DATA` (default ../shared/data); else generated streets of the same size.

OMPL: RRT-Connect plans with our validator, one call for each motion, and with the plain Python
callback of one state at most `_STEP` apart from the next; both ask the same planar checker.
navmesh: the time of the first plan on the map, of later plans on average, and of plans on a map
that grows by one obstacle before each, as a mapping agent's does, against plans from scratch.
All times are processor time; searches are in one thread.
"""

import os
from collections.abc import Callable, Iterator
from functools import cache, partial
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from benchnav_baselines.common.validity_checker import CountingChecker, PlanarChecker
from benchnav_baselines.planners.ompl.budget import Budget
from benchnav_baselines.planners.ompl.search import Query, load, search, space_information

from benchmarks.pair import Pair
from benchnav.arena.solid import Kind, Solid
from benchnav.arrays import FloatArray
from benchnav.geometry import FreeSpace
from benchnav.navigation import Map
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import PLANNERS
from benchnav.scenario.files.occupancy import trace
from benchnav.scenario.importers import movingai
from benchnav.scenario.importers.grid import Occupancy

RADIUS, TOLERANCE = 0.3, 0.3  # [m]
PLANS, GROWN, GEODESICS, MOTIONS = 200, 20, 1000, 10_000
_STEP = 0.1  # [m] between the states that the plain callback checks
_RANGE = 8.0  # [m] of a motion of RRT-Connect
_SIZE, _SEED = 256, 0
_DATA = Path(os.environ.get("BENCHNAV_DATA", Path(__file__).parents[2] / "shared" / "data"))
NAME = "Berlin_1_256"
CITY = _DATA / "movingai" / f"{NAME}.map"

Ends = tuple[FloatArray, FloatArray]  # start and goal (2,) [m]
Check = Callable[[Map, Ends, PlanarChecker], tuple[int, float]]
"""A search → the number of motions that it checked, and its time [s]."""


def pairs() -> list[Pair]:
    """Return the pairs of all planners."""
    name = NAME if CITY.exists() else f"streets of {_SIZE} × {_SIZE} m"
    return [
        Pair(
            name=f"OMPL's RRT-Connect, {name}", unit="motions/s",
            peer=f"callback every {_STEP} m", wanted=10.0, blocks=2,
            limit="OMPL itself and its call into Python take two thirds of a motion's time.",
            ours=partial(motions, _swept_motions),
            theirs=partial(motions, _state_motions),
        ),
        Pair(
            name=f"navmesh, {name}: the first plan", unit="s", wanted=2.0,
            ours=first_plan,
        ),
        Pair(
            name=f"navmesh, {name}: a later plan", unit="plans/s", wanted=200.0,
            ours=later_plans,
        ),
        Pair(
            name=f"navmesh, {name}: a plan after one more obstacle", unit="plans/s",
            peer="from scratch", wanted=3.0, blocks=1,
            ours=partial(growing_map, True),
            theirs=partial(growing_map, False),
        ),
        Pair(
            name=f"{GEODESICS:,} geodesics, {name}", unit="s", wanted=30.0, blocks=1,
            ours=geodesics,
        ),
    ]  # fmt: skip


@cache
def city() -> tuple[Map, list[Ends]]:
    """Return the map, and queries between free places."""
    if CITY.exists():
        occupancy = movingai.read_map(CITY)
        scen = movingai.read_scen(CITY.with_name(f"{NAME}-even-1.scen"), CITY, occupancy)
        ends = [(scen.start[k], scen.goal[k]) for k in range(len(scen.length))]
    else:
        occupancy, ends = streets(np.random.default_rng(_SEED))
    queries = [(occupancy.centres(*a), occupancy.centres(*b)) for a, b in ends]
    return Map(occupancy.bounds, trace(occupancy)), queries


def streets(rng: np.random.Generator) -> tuple[Occupancy, list[tuple[Any, Any]]]:
    """Return a map of blocks with jagged sides between streets, and pairs of free cells."""
    blocked = np.zeros((_SIZE, _SIZE), np.bool_)
    lines = [list(_lines(rng)) for _ in range(2)]
    for low, high in lines[0]:
        for left, right in lines[1]:
            if rng.random() < 0.9:
                blocked[low:high, left:right] = True
                for _ in range(12):  # bays
                    i, j = rng.integers(low, high), rng.choice([left, right - 1])
                    blocked[i : i + rng.integers(1, 4), j] = False
    free = np.argwhere(~blocked)[:, ::-1]
    chosen = free[rng.integers(0, len(free), (950, 2))]
    nothing = np.zeros_like(blocked)
    return Occupancy(blocked, nothing, 1.0, (0.0, 0.0, 0.0)), [(a, b) for a, b in chosen]


def _lines(rng: np.random.Generator) -> Iterator[tuple[int, int]]:
    """Yield where blocks begin and end along an axis."""
    at = int(rng.integers(2, 6))
    while at < _SIZE - 10:
        end = min(at + int(rng.integers(8, 30)), _SIZE - 2)
        yield at, end
        at = end + int(rng.integers(3, 7))


def motions(check: Check) -> float:
    """Return motions checked a second."""
    map, queries = city()
    checker = PlanarChecker(map, RADIUS)
    count, seconds, k = 0, 0.0, 0
    while count < MOTIONS:
        more, time = check(map, queries[k % len(queries)], checker)
        count, seconds, k = count + more, seconds + time, k + 1
    return count / seconds


def _rrt_connect(geometric: Any, information: Any) -> Any:
    planner = geometric.RRTConnect(information)
    planner.setRange(_RANGE)
    return planner


def _swept_motions(map: Map, ends: Ends, checker: PlanarChecker) -> tuple[int, float]:
    """Return (motions checked, seconds) of a search with one call for each motion."""
    counted = CountingChecker(checker)
    began = process_time()
    search(_rrt_connect, Query(*ends, map.bounds), counted, 1, Budget(100_000))
    return counted.checks, process_time() - began


def _state_motions(map: Map, ends: Ends, checker: PlanarChecker) -> tuple[int, float]:
    """Return the same of a search with one call for each state."""
    base, geometric, util = load()
    util.RNG.setSeed(1)
    began = process_time()
    information = space_information(base, map.bounds, checker)
    space = information.getStateSpace()
    plain = base.SpaceInformation(space)
    plain.setStateValidityChecker(lambda state: checker.point_is_free(*state[0:2]))
    plain.setStateValidityCheckingResolution(_STEP / space.getMaximumExtent())
    plain.setup()
    problem = base.ProblemDefinition(plain)
    states = plain.allocState(), plain.allocState()
    for state, place in zip(states, ends, strict=True):
        state[0], state[1] = place.tolist()
    problem.setStartAndGoalStates(*states)
    planner = _rrt_connect(geometric, plain)
    planner.setProblemDefinition(problem)
    planner.setup()
    planner.solve(base.PlannerTerminationCondition(Budget(100_000)))
    return plain.getMotionValidator().getCheckedMotionCount(), process_time() - began


def first_plan() -> float:
    """Return how often a second the map can be meshed and asked once."""
    map, queries = city()
    return 1.0 / _seconds(_asked(), map, *queries[0])


def later_plans() -> float:
    """Return plans a second on a map that is meshed already."""
    map, queries = city()
    ask = _asked()
    ask(map, *queries[0])
    return PLANS / sum(_seconds(ask, map, *ends) for ends in queries[:PLANS])


def growing_map(keep: bool) -> float:
    """Return plans a second on a map that gets one more obstacle before each.

    The first plan, on the map before, is not timed. With ``keep``, one planner makes all plans;
    else each is made by a new one.
    """
    map, queries = city()
    ask, solids, seconds = _asked(), map.solids, 0.0
    ask(map, *queries[0])
    for k in range(GROWN):
        x, y = queries[-1 - k][0].tolist()
        solids = (*solids, Solid(Kind.STATIC, center=(x, y), radius=0.3))
        grown = Map(map.bounds, solids)
        seconds += _seconds(ask if keep else _asked(), grown, *queries[k])
    return GROWN / seconds


def geodesics() -> float:
    """Return how often a second all exact shortest paths can be computed, with their graph."""
    map, queries = city()
    began = process_time()
    space = FreeSpace(map.capsules, RADIUS)
    for k in range(GEODESICS):
        space.length(*queries[k % len(queries)], TOLERANCE)
    return 1.0 / (process_time() - began)


def _asked() -> Callable[..., object]:
    """Return the plan call of a new planner."""
    rng = np.random.default_rng(_SEED)
    planner = make(PLANNERS, "navmesh")
    return partial(planner.plan, radius=RADIUS, tolerance=TOLERANCE, rng=rng)


def _seconds(call: Callable[..., object], *arguments: object) -> float:
    began = process_time()
    call(*arguments)
    return process_time() - began
