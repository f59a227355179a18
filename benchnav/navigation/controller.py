"""The contract of a controller: path + observation → command."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from benchnav.arena.sensing import Sensing
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.navigator import (
    ALL_DYNAMICS,
    CommandKind,
    DynamicsName,
    Need,
    PluginConfig,
    Training,
)
from benchnav.navigation.observation import Observation


@dataclass(frozen=True, eq=False)
class Guide:
    """The current targets on the paths, from the path tracker that all controllers share."""

    target: FloatArray  # (B, A, 2) [m] point on the path, a lookahead ahead of the agent
    remaining: FloatArray  # (B, A) [m] path length from the agent's projection to the end
    has_path: BoolArray  # (B, A) False if planning found no path (the target is then the goal)
    clearance: FloatArray | None = None
    """(B, A) [m] between the agent and the obstacles at the narrowest place of its path. A
    controller that keeps more distance from walls cannot follow the path. inf: enough or unknown;
    None: unknown for all agents."""


class Controller(ABC):
    """Follows guides while reacting to what is sensed."""

    Config: ClassVar[type[PluginConfig]] = PluginConfig
    needs: ClassVar[frozenset[Need]] = frozenset()
    drives: ClassVar[frozenset[DynamicsName]] = ALL_DYNAMICS  # see `Navigator.drives`
    command: ClassVar[CommandKind] = "velocity"
    lookahead: ClassVar[float] = 1.0  # [m] of path to the target, at most; a default
    adapts_clearance: ClassVar[bool] = False  # whether `Guide.clearance` bounds its wall distance
    cut: ClassVar[float] = 0.1  # [m] by which the agent may miss corners; a default

    def __init__(self, config: PluginConfig | None = None) -> None:
        self.config: Any = config if config is not None else self.Config()

    @property
    def required(self) -> frozenset[Need]:
        """The needs of this configured instance."""
        return self.needs

    @property
    def training(self) -> Training | None:
        """The cost of training; None for a controller that does not learn."""
        return None

    @property
    def fingerprint(self) -> str:
        """The fingerprint of the files that it reads, such as weights; "" if it reads none."""
        return ""

    def unfit(self, sensing: Sensing) -> str:
        """Return why it cannot use this sensing, beyond missing needs; "" if it can."""
        return ""

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:  # noqa: B027 - optional
        """Start the worlds ``rows`` (N,)."""

    @abstractmethod
    def steer(self, observation: Observation, guide: Guide) -> FloatArray:
        """Return the commands (B, A, 2)."""
