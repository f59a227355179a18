"""The contract of a planner: map, start, goal → path."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.navigation.map import Map
from benchnav.navigation.navigator import PluginConfig


@dataclass(frozen=True, eq=False)
class Plan:
    """A path, or the statement that none was found (a result, not an exception)."""

    path: FloatArray  # (W, 2) [m] from start to goal; (0, 2) if unsolved
    solved: bool
    checks: int = 0  # motions that were checked for validity
    reason: str = ""  # why unsolved
    clearance: float = math.inf  # [m] from disc to obstacles at the narrowest place; inf: enough

    @property
    def length(self) -> float:
        """The length of the path [m]; inf if unsolved."""
        if not self.solved:
            return float("inf")
        return float(np.sum(np.hypot(*np.diff(self.path, axis=0).T)))


UNSOLVED = np.zeros((0, 2))


class Planner(ABC):
    """Plans paths for a disc; deterministic for a given generator."""

    Config: ClassVar[type[PluginConfig]] = PluginConfig

    def __init__(self, config: PluginConfig | None = None) -> None:
        self.config: Any = config if config is not None else self.Config()

    @property
    def reproducible(self) -> bool:
        """Whether equal inputs give equal plans; False if a wall-clock budget affects them."""
        return True

    @abstractmethod
    def plan(
        self,
        map: Map,
        start: FloatArray,
        goal: FloatArray,
        radius: float,
        tolerance: float,
        rng: np.random.Generator,
    ) -> Plan:
        """Return a path (W, 2) for a disc of ``radius`` [m], within ``tolerance`` [m] of the goal.

        If there is none, or none is found, the plan is not solved and gives the reason in a few
        words, which is stored with the episode and shown beside the results. An exception, or a
        result that is not a plan, fails the episode.
        """
