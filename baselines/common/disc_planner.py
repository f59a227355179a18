"""What planners without randomness share: the straight way, then a search; and reasons."""

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.navigation.map import Map
from benchnav.navigation.planner import UNSOLVED, Plan

from .clearance_planner import ClearancePlanner, free_goal, problem
from .validity_checker import SKIN, Checker, PlanarChecker

Frame = tuple[float, float, float, float]  # xmin, ymin, xmax, ymax [m]
WITHIN = 0.99  # of the tolerance: how far from a blocked goal a path may end
_LEAST = 1e-6  # [m] a point is planned for as a disc of this radius


@dataclass(frozen=True, eq=False)
class Query:
    """From where to where, for which disc."""

    map: Map
    start: FloatArray  # (2,) [m], free for the disc
    goal: FloatArray  # (2,) [m]
    reach: float  # [m] radius of the disc and the clearance
    tolerance: float  # [m] a path may end so far from the goal
    checker: Checker

    @property
    def inflation(self) -> float:
        """[m] by which obstacles grow: the reach, less what contact may overlap by rounding."""
        return max(self.reach - SKIN, _LEAST)

    @property
    def slack(self) -> float:
        """[m] from the goal within which a path that cannot reach it ends."""
        return WITHIN * max(self.tolerance, 0.0)


class DiscPlanner(ClearancePlanner):
    """Plans without drawing anything. A motion that is free straight is the path."""

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
        """As `Planner.plan`; ``rng`` is not used.

        Where the goal cannot be reached, the path ends within the tolerance of it.
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
        """Why there is no path between free places."""
        return "no path leads to the goal"

    @abstractmethod
    def search(self, query: Query) -> tuple[FloatArray, int]:
        """(path (W, 2), motions checked); (0, 2) where there is no path."""

    def _straight_or_found(self, query: Query) -> tuple[FloatArray, int]:
        ends, free = (query.start, query.goal), query.checker
        if free.point_is_free(*query.goal.tolist()) and free.motion_is_free(
            *query.start.tolist(), *query.goal.tolist()
        ):
            return np.array(ends), 1
        path, checks = self.search(query)
        return path, checks + 1


def frame_of(query: Query, margin: float) -> Frame:
    """A box around all that stands and the map's bounds, with room to pass around it.

    It is the same for all queries of a map and a radius that lie within it, and
    grows by its own size for those that do not.
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
