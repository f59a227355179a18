"""What planners without randomness share: clearance, the straight way, reasons."""

from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from pydantic import Field

from benchnav.arrays import FloatArray
from benchnav.navigation.map import Map
from benchnav.navigation.navigator import PluginConfig
from benchnav.navigation.planner import UNSOLVED, Plan, Planner

from .ompl.checker import SKIN, PlanarChecker
from .ompl.planner import free_goal

Frame = tuple[float, float, float, float]  # xmin, ymin, xmax, ymax [m]
WITHIN = 0.99  # of the tolerance: how far from a blocked goal a path may end
_LEAST = 1e-6  # [m] a point is planned for as a disc of this radius


class DiscConfig(PluginConfig):
    """Parameters of every planner here."""

    clearance: float = Field(
        0.05, ge=0, description="[m] kept from obstacles where start, goal and passages allow it"
    )


@dataclass(frozen=True, eq=False)
class Query:
    """From where to where, for which disc."""

    map: Map
    start: FloatArray  # (2,) [m], free for the disc
    goal: FloatArray  # (2,) [m]
    reach: float  # [m] radius of the disc and the clearance
    tolerance: float  # [m] a path may end so far from the goal
    checker: PlanarChecker

    @property
    def inflation(self) -> float:
        """[m] by which obstacles grow: the reach, less what contact may overlap by rounding."""
        return max(self.reach - SKIN, _LEAST)

    @property
    def slack(self) -> float:
        """[m] from the goal within which a path that cannot reach it ends."""
        return WITHIN * max(self.tolerance, 0.0)


class DiscPlanner(Planner):
    """Plans for the disc enlarged by a clearance, by less of it where that finds nothing.

    The clearance is ½ or ¼ of what is wanted where start or goal are nearer to an
    obstacle, and 0 where nothing is found with it. A motion that is free straight is
    the path.
    """

    class Config(DiscConfig):
        """Parameters."""

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._checkers: WeakKeyDictionary[Map, dict[float, PlanarChecker]] = WeakKeyDictionary()

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
        if not (np.isfinite([*start, *goal, radius, tolerance]).all() and radius >= 0.0):
            return Plan(UNSOLVED, False, 0, "start, goal, radius or tolerance is not finite")
        start, goal = np.array(start, np.float64), np.array(goal, np.float64)
        checks = 0
        for extra in self._clearances(map, start, goal, radius):
            reach = radius + extra
            query = Query(map, start, goal, reach, tolerance, self._checker(map, reach))
            path, more = self._straight_or_found(query)
            checks += more
            if len(path):
                return Plan(path, True, checks)
        checker = self._checker(map, radius)
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

    def _clearances(
        self, map: Map, start: FloatArray, goal: FloatArray, radius: float
    ) -> Iterator[float]:
        """The largest clearance that both ends allow, then 0; none where the start is blocked."""
        wanted = self.config.clearance
        for extra in (wanted, 0.5 * wanted, 0.25 * wanted):
            checker = self._checker(map, radius + extra)
            if extra > 0.0 and all(checker.point_is_free(*p.tolist()) for p in (start, goal)):
                yield extra
                break
        if self._checker(map, radius).point_is_free(*start.tolist()):
            yield 0.0

    def _checker(self, map: Map, reach: float) -> PlanarChecker:
        known = self._checkers.setdefault(map, {})
        if reach not in known:
            known[reach] = PlanarChecker(map, reach)
        return known[reach]


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
