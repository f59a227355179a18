"""One search by an OMPL planner, reproducible for its seed.

OMPL's random numbers start from one process-wide seed: it is set before each new
space and planner. Every OMPL object is created, used and dropped within a function,
because objects that exist at exit are reported as leaks.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from benchnav.arrays import Extent, FloatArray
from benchnav.errors import MissingExtraError

from ...common.validity_checker import Checker
from .budget import Budget

Make = Callable[[Any, Any], Any]  # (ompl.geometric, space information) → planner


@dataclass(frozen=True, eq=False)
class Query:
    """Start, goal and bounds of a plan."""

    start: FloatArray  # (2,) [m]
    goal: FloatArray  # (2,) [m]
    bounds: Extent


def load() -> tuple[Any, Any, Any]:
    """Return OMPL's modules base, geometric and util, silenced.

    Raises MissingExtraError if OMPL is not installed.
    """
    try:
        from ompl import base, geometric, util
    except ImportError:
        raise MissingExtraError("An OMPL planner", "plan") from None
    util.setLogLevel(util.LOG_NONE)
    return base, geometric, util


def space_information(base: Any, bounds: Extent, checker: Checker) -> Any:
    """Return the plane within ``bounds``, with ``checker`` as the validity check."""
    space = base.RealVectorStateSpace(2)
    limits = base.RealVectorBounds(2)
    for axis in (0, 1):
        limits.setLow(axis, bounds[axis])
        limits.setHigh(axis, bounds[axis + 2])
    space.setBounds(limits)
    information = base.SpaceInformation(space)
    information.setStateValidityChecker(lambda state: checker.point_is_free(state[0], state[1]))
    information.setMotionValidator(_validator_class()(information, checker))
    information.setup()
    return information


def search(make: Make, query: Query, checker: Checker, seed: int, budget: Budget) -> FloatArray:
    """Return the path (W, 2) [m] that the planner finds within its budget; (0, 2) if none."""
    base, geometric, util = load()
    util.RNG.setSeed(seed)
    information = space_information(base, query.bounds, checker)
    problem = base.ProblemDefinition(information)
    ends = information.allocState(), information.allocState()
    for state, place in zip(ends, (query.start, query.goal), strict=True):
        state[0], state[1] = float(place[0]), float(place[1])
    problem.setStartAndGoalStates(*ends)
    problem.setOptimizationObjective(base.PathLengthOptimizationObjective(information))
    planner = make(geometric, information)
    planner.setProblemDefinition(problem)
    planner.setup()
    if hasattr(planner, "bestCost"):
        budget.best_cost = lambda: float(planner.bestCost().value())
    planner.solve(base.PlannerTerminationCondition(budget))
    budget.best_cost = None
    if not problem.hasExactSolution():
        return np.zeros((0, 2))
    return np.array([state[0:2] for state in problem.getSolutionPath().getStates()])


@cache
def _validator_class() -> Any:
    """Return OMPL's validator of motions, with one call per motion instead of sampled states."""
    base, _, _ = load()

    class SweptValidator(base.MotionValidator):  # type: ignore[misc, name-defined]  # a local module
        """Calls a `Checker`."""

        def __init__(self, information: Any, checker: Checker) -> None:
            super().__init__(information)
            self._free = checker.motion_is_free

        def checkMotion(self, start: Any, end: Any) -> bool:
            return self._free(start[0], start[1], end[0], end[1])

    return SweptValidator
