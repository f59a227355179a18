"""The common part of planners for a disc: choice of clearance, and blocked goals."""

import math
from abc import abstractmethod
from collections.abc import Iterator, Sequence
from weakref import WeakKeyDictionary

import numpy as np
from pydantic import Field

from benchnav.arrays import FloatArray
from benchnav.geometry import cos_sin
from benchnav.navigation import Map, Planner, PluginConfig

from .validity_checker import Checker


class ClearanceConfig(PluginConfig):
    """Parameters of every planner here."""

    clearance: float = Field(
        0.05,
        ge=0,
        description="[m] gap to obstacles; smaller if start, goal or passages are narrow",
    )


class ClearancePlanner(Planner):
    """Plans for the disc enlarged by a clearance, which is reduced if no path is found.

    The clearance is ½ or ¼ of the configured value if start or goal are closer to an
    obstacle. If no path is found with it, ⅛ is tried and then 0.
    """

    class Config(ClearanceConfig):
        """Parameters."""

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._checkers: WeakKeyDictionary[Map, dict[float, Checker]] = WeakKeyDictionary()

    @abstractmethod
    def new_checker(self, map: Map, reach: float) -> Checker:
        """Return the checker of a disc of radius ``reach`` [m]."""

    def checker(self, map: Map, reach: float) -> Checker:
        """Return the checker of a map and a radius [m], from a cache."""
        known = self._checkers.setdefault(map, {})
        if reach not in known:
            known[reach] = self.new_checker(map, reach)
        return known[reach]

    def clearances(
        self, map: Map, start: FloatArray, goal: FloatArray, radius: float
    ) -> Iterator[float]:
        """Yield the largest clearance that both ends allow, then ⅛ of the configured value, then 0.

        If an end does not even allow ¼, ⅛ is tried only if one is in a narrow place. No value
        is yielded if the start is blocked.
        """
        configured = self.config.clearance
        least, ends = 0.125 * configured, (start, goal)
        shares = (
            extra for extra in (configured, 0.5 * configured, 0.25 * configured) if extra > 0.0
        )
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
        """Return the clearance [m] of a path found with ``extra``, for `Plan.clearance`.

        The path passes a narrow place if no path was found with the clearance that its ends allow,
        or if an end is in a narrow place.
        """
        allowed = next(self.clearances(map, start, goal, radius), 0.0)
        narrow = extra < allowed or self._is_narrow(map, (start, goal), radius)
        return extra if narrow else math.inf

    def _are_free(self, map: Map, places: Sequence[FloatArray], reach: float) -> bool:
        checker = self.checker(map, reach)
        return all(checker.point_is_free(*place.tolist()) for place in places)

    def _is_narrow(self, map: Map, places: Sequence[FloatArray], radius: float) -> bool:
        """Whether a place has no free space beside it that keeps the configured clearance.

        Blocked places do not count: there a path ends before them.
        """
        configured = self.config.clearance
        wide = self.checker(map, radius + configured)
        return any(
            self._are_free(map, (place,), radius)
            and free_goal(wide, place, 2.0 * configured) is None
            for place in places
        )


def problem(start: FloatArray, goal: FloatArray, radius: float, tolerance: float) -> str:
    """Return the problem with a query; "" if there is none."""
    if np.isfinite([*start, *goal, radius, tolerance]).all() and radius >= 0.0:
        return ""
    return "start, goal, radius or tolerance is not finite"


def free_goal(checker: Checker, goal: FloatArray, tolerance: float) -> FloatArray | None:
    """Return the goal (2,), or if it is blocked, the nearest free place within the tolerance."""
    if checker.point_is_free(*goal.tolist()):
        return goal
    for share in (0.25, 0.5, 0.75, 0.99):
        for turn in range(16):
            c, s = cos_sin(turn * np.pi / 8.0)
            place = goal + share * tolerance * np.array([c, s])
            if checker.point_is_free(*place.tolist()):
                return place
    return None
