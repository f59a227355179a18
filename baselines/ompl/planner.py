"""What all planners of the Open Motion Planning Library share (Sucan, Moll & Kavraki 2012)."""

from abc import abstractmethod
from collections.abc import Iterator
from weakref import WeakKeyDictionary

import numpy as np
from pydantic import Field

from benchnav.arrays import FloatArray
from benchnav.geometry.rotation import cos_sin
from benchnav.navigation.map import Map
from benchnav.navigation.navigator import PluginConfig
from benchnav.navigation.planner import UNSOLVED, Plan, Planner

from .checker import Checker, CheckerName, CountingChecker, checker_for
from .shortcut import shortened

MOST_SEED = 2**31 - 1


class OmplConfig(PluginConfig):
    """Parameters of every OMPL planner."""

    iterations: int = Field(
        20_000, ge=1, description="calls of the termination condition until it gives up"
    )
    seconds: float | None = Field(
        None, gt=0, description="[s] of wall clock that a search may take besides; not reproducible"
    )
    clearance: float = Field(
        0.05, ge=0, description="[m] kept from obstacles where start, goal and passages allow it"
    )
    simplify: bool = Field(True, description="skip waypoints and pull the path taut afterwards")
    checker: CheckerName = Field(
        "planar", description="exact swept test in the plane, or python-fcl on the map's meshes"
    )


class OmplPlanner(Planner):
    """What the planners share: clearance, straight paths, simplification, reasons."""

    class Config(OmplConfig):
        """Parameters."""

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._checkers: WeakKeyDictionary[Map, dict[float, Checker]] = WeakKeyDictionary()

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
        """As `Planner.plan`. A path that is free straight is answered without a search.

        The radius is enlarged by the clearance, by less of it (½, ¼, 0) where start or
        goal are nearer to an obstacle, and by 0 where nothing is found with it. Where the
        goal is blocked, the path ends at a free place within the tolerance of it.
        """
        if not (np.isfinite([*start, *goal, radius, tolerance]).all() and radius >= 0.0):
            return Plan(UNSOLVED, False, 0, "start, goal, radius or tolerance is not finite")
        checks, reason = 0, "the start is blocked"
        seed = int(rng.integers(1, MOST_SEED))
        for extra in self._clearances(map, start, goal, radius, tolerance):
            checker = CountingChecker(self._checker(map, radius + extra))
            end = free_goal(checker, goal, tolerance)
            if end is None:
                reason = "the goal is blocked"
                break
            path = self._path(map, start, end, radius + extra, checker, seed)
            checks += checker.checks
            if len(path):
                return Plan(path, True, checks)
            reason = "no path was found within the budget"
        return Plan(UNSOLVED, False, checks, reason)

    def _clearances(
        self, map: Map, start: FloatArray, goal: FloatArray, radius: float, tolerance: float
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

    def _checker(self, map: Map, radius: float) -> Checker:
        known = self._checkers.setdefault(map, {})
        if radius not in known:
            known[radius] = checker_for(self.config.checker, map, radius)
        return known[radius]

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
        """A path (W, 2) for a disc of radius ``reach`` [m]; (0, 2) if none is found."""


def free_goal(checker: Checker, goal: FloatArray, tolerance: float) -> FloatArray | None:
    """The goal (2,), or where it is blocked a free place within the tolerance, near ones first."""
    if checker.point_is_free(*goal.tolist()):
        return goal
    for share in (0.25, 0.5, 0.75, 0.99):
        for turn in range(16):
            c, s = cos_sin(turn * np.pi / 8.0)
            place = goal + share * tolerance * np.array([c, s])
            if checker.point_is_free(*place.tolist()):
                return place
    return None
