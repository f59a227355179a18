"""The common part of planners of the Open Motion Planning Library (Sucan et al. 2012)."""

from abc import abstractmethod

import numpy as np
from pydantic import Field

from benchnav.arrays import FloatArray
from benchnav.navigation import UNSOLVED, Map, Plan, PluginConfig

from ...common.clearance_planner import ClearanceConfig, ClearancePlanner, free_goal, problem
from ...common.validity_checker import Checker, CheckerName, CountingChecker, checker_for
from .search import load
from .shortcut import shortened

MOST_SEED = 2**31 - 1


class OmplConfig(ClearanceConfig):
    """Parameters of every OMPL planner."""

    iterations: int = Field(
        20_000, ge=1, description="largest number of calls of the termination condition"
    )
    seconds: float | None = Field(
        None, gt=0, description="[s] additional limit of wall-clock time; not reproducible"
    )
    simplify: bool = Field(
        True, description="whether unnecessary waypoints are removed and the path is shortened"
    )
    checker: CheckerName = Field(
        "planar", description="exact swept test in the plane, or python-fcl on the map's meshes"
    )


class OmplPlanner(ClearancePlanner):
    """Adds to an OMPL search: straight paths, simplification, reasons."""

    class Config(OmplConfig):
        """Parameters."""

    def __init__(self, config: PluginConfig | None = None) -> None:
        """Raise MissingExtraError if OMPL is not installed."""
        super().__init__(config)
        load()

    @property
    def reproducible(self) -> bool:
        return self.config.seconds is None

    def plan(
        self,
        map: Map,
        start: FloatArray,
        goal: FloatArray,
        radius: float,
        tolerance: float,
        rng: np.random.Generator,
    ) -> Plan:
        """Plan like `Planner.plan`. A free straight motion is the path, without a search.

        If the goal is blocked, the path ends at a free place within the tolerance of it.
        """
        if wrong := problem(start, goal, radius, tolerance):
            return Plan(UNSOLVED, False, 0, wrong)
        checks, reason = 0, "the start is blocked"
        seed = int(rng.integers(1, MOST_SEED))
        for extra in self.clearances(map, start, goal, radius):
            checker = CountingChecker(self.checker(map, radius + extra))
            end = free_goal(checker, goal, tolerance)
            if end is None:
                reason = "the goal is blocked"
                break
            path = self._path(map, start, end, radius + extra, checker, seed)
            checks += checker.checks
            if len(path):
                return Plan(path, True, checks, "", self.left(map, start, goal, radius, extra))
            reason = "no path was found within the budget"
        return Plan(UNSOLVED, False, checks, reason)

    def new_checker(self, map: Map, reach: float) -> Checker:
        return checker_for(self.config.checker, map, reach)

    def _path(
        self, map: Map, start: FloatArray, goal: FloatArray, reach: float, checker: Checker,
        seed: int,
    ) -> FloatArray:  # fmt: skip
        if checker.motion_is_free(*start.tolist(), *goal.tolist()):
            return np.array([start, goal])
        path = self._search(map, start, goal, reach, checker, seed)
        if not len(path) or not self.config.simplify:
            return path
        return shortened(path, checker)

    @abstractmethod
    def _search(
        self, map: Map, start: FloatArray, goal: FloatArray, reach: float, checker: Checker,
        seed: int,
    ) -> FloatArray:  # fmt: skip
        """Return a path (W, 2) for a disc of radius ``reach`` [m]; (0, 2) if none is found."""
