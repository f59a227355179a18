"""What planners for a disc share: how much clearance is tried, and where a blocked goal ends."""

import math
from abc import abstractmethod
from collections.abc import Iterator, Sequence
from weakref import WeakKeyDictionary

import numpy as np
from pydantic import Field

from benchnav.arrays import FloatArray
from benchnav.geometry.rotation import cos_sin
from benchnav.navigation.map import Map
from benchnav.navigation.navigator import PluginConfig
from benchnav.navigation.planner import Planner

from .validity_checker import Checker


class ClearanceConfig(PluginConfig):
    """Parameters of every planner here."""

    clearance: float = Field(
        0.05, ge=0, description="[m] kept from obstacles where start, goal and passages allow it"
    )


class ClearancePlanner(Planner):
    """Plans for the disc enlarged by a clearance, by less of it where that finds nothing.

    The clearance is ½ or ¼ of what is wanted where start or goal are nearer to an
    obstacle. Where nothing is found with it, ⅛ is tried and then 0.
    """

    class Config(ClearanceConfig):
        """Parameters."""

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._checkers: WeakKeyDictionary[Map, dict[float, Checker]] = WeakKeyDictionary()

    @abstractmethod
    def new_checker(self, map: Map, reach: float) -> Checker:
        """Of a disc of radius ``reach`` [m]."""

    def checker(self, map: Map, reach: float) -> Checker:
        """The one of a map and a radius [m]."""
        known = self._checkers.setdefault(map, {})
        if reach not in known:
            known[reach] = self.new_checker(map, reach)
        return known[reach]

    def clearances(
        self, map: Map, start: FloatArray, goal: FloatArray, radius: float
    ) -> Iterator[float]:
        """The largest clearance that both ends allow, then ⅛ of what is wanted, then 0.

        Where both ends do not even allow ¼, ⅛ is tried only if one stands in a narrow place. None
        where the start is blocked.
        """
        wanted = self.config.clearance
        least, ends = 0.125 * wanted, (start, goal)
        shares = (extra for extra in (wanted, 0.5 * wanted, 0.25 * wanted) if extra > 0.0)
        first = next((e for e in shares if self._are_free(map, ends, radius + e)), 0.0)
        if first:
            yield first
        tried = least > 0.0 and (first > 0.0 or self._is_narrow(map, ends, radius))
        if tried and self._are_free(map, ends, radius + least):
            yield least
        if self._are_free(map, (start,), radius):
            yield 0.0

    def left(
        self, map: Map, start: FloatArray, goal: FloatArray, radius: float, extra: float
    ) -> float:
        """[m] What a path that was found with the clearance ``extra`` leaves, as `Plan.clearance`.

        It passes a narrow place where nothing was found with what its ends allow, or where an end
        stands in one.
        """
        allowed = next(self.clearances(map, start, goal, radius), 0.0)
        narrow = extra < allowed or self._is_narrow(map, (start, goal), radius)
        return extra if narrow else math.inf

    def _are_free(self, map: Map, places: Sequence[FloatArray], reach: float) -> bool:
        checker = self.checker(map, reach)
        return all(checker.point_is_free(*place.tolist()) for place in places)

    def _is_narrow(self, map: Map, places: Sequence[FloatArray], radius: float) -> bool:
        """Whether one has no room beside it, in which the clearance that is wanted is kept.

        Places that are blocked themselves do not count: there a path ends before them.
        """
        wanted = self.config.clearance
        wide = self.checker(map, radius + wanted)
        return any(
            self._are_free(map, (place,), radius) and free_goal(wide, place, 2.0 * wanted) is None
            for place in places
        )


def problem(start: FloatArray, goal: FloatArray, radius: float, tolerance: float) -> str:
    """What is wrong with a question; "" if nothing is."""
    if np.isfinite([*start, *goal, radius, tolerance]).all() and radius >= 0.0:
        return ""
    return "start, goal, radius or tolerance is not finite"


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
