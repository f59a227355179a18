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
from functools import partial
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from benchnav_baselines.common.validity_checker import CountingChecker, PlanarChecker
from benchnav_baselines.planners.ompl.budget import Budget
from benchnav_baselines.planners.ompl.search import Query, load, search, space_information

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
PLANS, GROWN, GEODESICS, MOTIONS = 200, 20, 1000, 20_000
_STEP = 0.1  # [m] between the states that the plain callback checks
_RANGE = 8.0  # [m] of a motion of RRT-Connect
_SIZE, _SEED = 256, 0
_DATA = Path(os.environ.get("BENCHNAV_DATA", Path(__file__).parents[2] / "shared" / "data"))

_PILLAR = Map((-9.0, -9.0, 9.0, 9.0), (Solid(Kind.STATIC, center=(-2.0, 2.0), radius=3.0),))
_AROUND_IT = np.array([[-6.0, 2.0], [2.0, 2.5]])  # start and goal; a first search loads the kernels

Ends = tuple[FloatArray, FloatArray]  # start and goal (2,) [m]


def measure() -> list[dict[str, object]]:
    """Return the rows."""
    name, map, queries = city()
    return [ompl_row(name, map, queries), *navmesh_rows(name, map, queries),
            geodesic_row(name, map, queries)]  # fmt: skip


def city() -> tuple[str, Map, list[Ends]]:
    """Return the name of the map, the map, and queries between free places."""
    path = _DATA / "movingai" / "Berlin_1_256.map"
    if path.exists():
        occupancy = movingai.read_map(path)
        scen = movingai.read_scen(path.with_name("Berlin_1_256-even-1.scen"), path, occupancy)
        ends = [(scen.start[k], scen.goal[k]) for k in range(len(scen.length))]
        name = "Berlin_1_256"
    else:
        occupancy, ends = streets(np.random.default_rng(_SEED))
        name = f"streets of {_SIZE} × {_SIZE} m"
    queries = [(occupancy.centres(*a), occupancy.centres(*b)) for a, b in ends]
    return name, Map(occupancy.bounds, trace(occupancy)), queries


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


def ompl_row(name: str, map: Map, queries: list[Ends]) -> dict[str, object]:
    """Return a row: motions a second, those of the plain callback as its peer."""
    checker = PlanarChecker(map, RADIUS)
    rates: dict[Callable[..., tuple[int, float]], float] = {}
    for motions in (_swept_motions, _state_motions):
        motions(map, queries[0], checker)  # loads the kernels
        count, seconds, k = 0, 0.0, 0
        while count < MOTIONS:
            more, time = motions(map, queries[k % len(queries)], checker)
            count, seconds, k = count + more, seconds + time, k + 1
        rates[motions] = count / seconds
    swept, plain = rates[_swept_motions], rates[_state_motions]
    return {
        "name": f"OMPL's RRT-Connect, {name}; peer: callback every {_STEP} m",
        "value": swept, "unit": "motions/s", "peer": plain, "ratio": swept / plain, "wanted": 10.0,
    }  # fmt: skip


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


def navmesh_rows(name: str, map: Map, queries: list[Ends]) -> list[dict[str, object]]:
    """Return rows: the first plan, later plans, and plans on a map that grows."""
    rng = np.random.default_rng(_SEED)
    make(PLANNERS, "navmesh").plan(_PILLAR, *_AROUND_IT, RADIUS, TOLERANCE, rng)
    planner = make(PLANNERS, "navmesh")
    ask = partial(planner.plan, radius=RADIUS, tolerance=TOLERANCE, rng=rng)
    first = _seconds(ask, map, *queries[0])
    later = [_seconds(ask, map, *ends) for ends in queries[:PLANS]]
    kept, scratch = [], []
    solids = map.solids
    for k in range(GROWN):
        x, y = queries[-1 - k][0].tolist()
        solids = (*solids, Solid(Kind.STATIC, center=(x, y), radius=0.3))
        grown = Map(map.bounds, solids)
        kept.append(_seconds(ask, grown, *queries[k]))
        new = make(PLANNERS, "navmesh")
        scratch.append(_seconds(new.plan, grown, *queries[k], RADIUS, TOLERANCE, rng))
    whole, part = float(np.mean(scratch)), float(np.mean(kept))
    mean = 1e3 * float(np.mean(later))
    return [
        _lower(f"navmesh, {name}: the first plan", first, "s", 2.0),
        _lower(f"navmesh, {name}: a later plan, mean of {PLANS}", mean, "ms", 5.0),
        {
            "name": f"navmesh, {name}: a plan after one more obstacle; peer: from scratch",
            "value": 1.0 / part, "unit": "plans/s", "peer": 1.0 / whole, "ratio": whole / part,
            "wanted": 3.0,
        },
    ]  # fmt: skip


def geodesic_row(name: str, map: Map, queries: list[Ends]) -> dict[str, object]:
    """Return a row: exact shortest paths, with the graph that they share."""
    FreeSpace(_PILLAR.capsules, RADIUS).length(*_AROUND_IT, TOLERANCE)
    began = process_time()
    space = FreeSpace(map.capsules, RADIUS)
    for k in range(GEODESICS):
        space.length(*queries[k % len(queries)], TOLERANCE)
    return _lower(f"{GEODESICS:,} geodesics, {name}", process_time() - began, "s", 30.0)


def _seconds(call: Callable[..., object], *arguments: object) -> float:
    began = process_time()
    call(*arguments)
    return process_time() - began


def _lower(name: str, value: float, unit: str, wanted: float) -> dict[str, object]:
    """Return a row whose value is to be at most ``wanted``."""
    return {
        "name": name, "value": value, "unit": unit, "wanted": wanted, "ratio": wanted / value,
    }  # fmt: skip


if __name__ == "__main__":
    print(*measure(), sep="\n")
