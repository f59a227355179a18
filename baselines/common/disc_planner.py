"""The common part of deterministic planners: the straight motion, then a search; and reasons."""

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from benchnav.arrays import Extent, FloatArray
from benchnav.navigation import UNSOLVED, Map, Plan

from .clearance_planner import ClearancePlanner, free_goal, problem
from .validity_checker import SKIN, Checker, PlanarChecker

WITHIN = 0.99  # share of the tolerance, in which a path to a blocked goal ends
_MIN_RADIUS = 1e-6  # [m] a point is planned for as a disc of this radius


@dataclass(frozen=True, eq=False)
class Query:
    """Start, goal and disc of a plan."""

    map: Map
    start: FloatArray  # (2,) [m], free for the disc
    goal: FloatArray  # (2,) [m]
    reach: float  # [m] radius of the disc and the clearance
    tolerance: float  # [m] largest distance from the goal to the path's end
    checker: Checker

    @property
    def inflation(self) -> float:
        """The growth [m] of obstacles: the reach, minus the overlap of contacts by rounding."""
        return max(self.reach - SKIN, _MIN_RADIUS)

    @property
    def slack(self) -> float:
        """The distance [m] from the goal within which a path to an unreachable goal ends."""
        return WITHIN * max(self.tolerance, 0.0)


class DiscPlanner(ClearancePlanner):
    """Plans without random numbers. If the straight motion is free, it is the path."""

    def new_checker(self, map: Map, reach: float) -> Checker:
        return PlanarChecker(map, reach)

    def plan(
        self,
        map: Map,
        start: FloatArray,
        goal: FloatArray,
        radius: float,
        tolerance: float,
        rng: np.random.Generator,
    ) -> Plan:
        """Plan like `Planner.plan`; ``rng`` is not used.

        If the goal cannot be reached, the path ends within the tolerance of it.
        """
        if wrong := problem(start, goal, radius, tolerance):
            return Plan(UNSOLVED, False, 0, wrong)
        start, goal = np.array(start, np.float64), np.array(goal, np.float64)
        checks = 0
        for extra in self.clearances(map, start, goal, radius):
            reach = radius + extra
            query = Query(map, start, goal, reach, tolerance, self.checker(map, reach))
            path, more = self._straight_or_found(query)
            checks += more
            if len(path):
                return Plan(path, True, checks, "", self.left(map, start, goal, radius, extra))
        checker = self.checker(map, radius)
        if not checker.point_is_free(*start.tolist()):
            return Plan(UNSOLVED, False, checks, "the start is blocked")
        blocked = free_goal(checker, goal, tolerance) is None
        reason = "the goal is blocked" if blocked else self.nothing(map, start, goal, radius)
        return Plan(UNSOLVED, False, checks, reason)

    def nothing(self, map: Map, start: FloatArray, goal: FloatArray, radius: float) -> str:
        """Return why there is no path between free places."""
        return "no path leads to the goal"

    @abstractmethod
    def search(self, query: Query) -> tuple[FloatArray, int]:
        """Return (path (W, 2), motions checked); (0, 2) if there is no path."""

    def _straight_or_found(self, query: Query) -> tuple[FloatArray, int]:
        ends, free = (query.start, query.goal), query.checker
        if free.point_is_free(*query.goal.tolist()) and free.motion_is_free(
            *query.start.tolist(), *query.goal.tolist()
        ):
            return np.array(ends), 1
        path, checks = self.search(query)
        return path, checks + 1


def frame_of(query: Query, margin: float) -> Extent:
    """Return a box around all obstacles and the map's bounds, with space to pass around it.

    It is equal for all queries of a map and a radius that lie within it, and
    grows by its own size for others.
    """
    c = query.map.capsules
    grown = c[:, 4:] + query.inflation + margin
    low = np.vstack([c[:, :2] - grown, c[:, 2:4] - grown, [query.map.bounds[:2]]]).min(axis=0)
    high = np.vstack([c[:, :2] + grown, c[:, 2:4] + grown, [query.map.bounds[2:]]]).max(axis=0)
    size = np.maximum(high - low, 1.0)
    for place in (query.start, query.goal):
        while np.any(place < low) or np.any(place > high):
            low, high, size = low - size, high + size, 3.0 * size
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])
