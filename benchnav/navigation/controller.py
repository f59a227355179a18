"""The contract of a controller: path + observation → command."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from benchnav.arena.sensing import Sensing
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.navigator import CommandKind, Need, PluginConfig, Training
from benchnav.navigation.observation import Observation


@dataclass(frozen=True, eq=False)
class Guide:
    """Where the paths say to go now, made by the path tracker that all controllers share."""

    target: FloatArray  # (B, A, 2) [m] point on the path, a lookahead ahead of the agent
    remaining: FloatArray  # (B, A) [m] path length from the agent's projection to the end
    has_path: BoolArray  # (B, A) False where planning found nothing (target is then the goal)
    clearance: FloatArray | None = None
    """(B, A) [m] that the path leaves beside the agent in its narrowest place: a controller that
    keeps more from walls cannot follow it. inf where that is enough or not known; None: unknown
    for all."""


class Controller(ABC):
    """Follows guides while reacting to what is sensed."""

    Config: ClassVar[type[PluginConfig]] = PluginConfig
    needs: ClassVar[frozenset[Need]] = frozenset()
    command: ClassVar[CommandKind] = "velocity"
    lookahead: ClassVar[float] = 1.0  # [m] of path to its target, at most, unless told otherwise
    adapts_clearance: ClassVar[bool] = False  # keeps no more from walls than `Guide.clearance`
    cut: ClassVar[float] = 0.1  # [m] by which it may miss corners, unless told otherwise

    def __init__(self, config: PluginConfig | None = None) -> None:
        self.config: Any = config if config is not None else self.Config()

    @property
    def required(self) -> frozenset[Need]:
        """What this configured instance needs."""
        return self.needs

    @property
    def training(self) -> Training | None:
        """What it cost to train; None for what does not learn."""
        return None

    @property
    def fingerprint(self) -> str:
        """Of what it reads from files, weights say, beyond its Config and version."""
        return ""

    def unfit(self, sensing: Sensing) -> str:
        """Why it cannot drive agents that sense so, beyond what it needs; "" where it can."""
        return ""

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:  # noqa: B027 - optional
        """Start the worlds ``rows`` (N,)."""

    @abstractmethod
    def steer(self, observation: Observation, guide: Guide) -> FloatArray:
        """(B, A, 2) commands."""
