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

    path: FloatArray  # (W, 2) [m] from start to goal; (0, 2) where unsolved
    solved: bool
    checks: int = 0  # motions that were checked for validity
    reason: str = ""  # why unsolved
    clearance: float = math.inf  # [m] left beside the disc in the narrowest place; inf: enough

    @property
    def length(self) -> float:
        """[m]; inf where unsolved."""
        if not self.solved:
            return float("inf")
        return float(np.sum(np.hypot(*np.diff(self.path, axis=0).T)))


UNSOLVED = np.zeros((0, 2))


class Planner(ABC):
    """Plans for a disc. Deterministic for the generator that it is given."""

    Config: ClassVar[type[PluginConfig]] = PluginConfig

    def __init__(self, config: PluginConfig | None = None) -> None:
        self.config: Any = config if config is not None else self.Config()

    @property
    def reproducible(self) -> bool:
        """False where a wall-clock budget decides what it answers."""
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
        """A path (W, 2) for a disc of ``radius`` [m] that ends within ``tolerance`` [m] of goal.

        Where there is none, or none is found, the plan is not solved and gives the reason in a
        few words: it is kept with the episode and shown beside the results. What this raises,
        or returns that is no plan, fails the episode.
        """
