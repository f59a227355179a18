"""The contract of a controller: path + observation → command."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.navigator import CommandKind, Need, PluginConfig
from benchnav.navigation.observation import Observation


@dataclass(frozen=True, eq=False)
class Guide:
    """Where the paths say to go now, made by the path tracker that all controllers share."""

    target: FloatArray  # (B, A, 2) [m] point on the path, a lookahead ahead of the agent
    remaining: FloatArray  # (B, A) [m] path length from the agent's projection to the end
    has_path: BoolArray  # (B, A) False where planning found nothing (target is then the goal)


class Controller(ABC):
    """Follows guides while reacting to what is sensed."""

    Config: ClassVar[type[PluginConfig]] = PluginConfig
    needs: ClassVar[frozenset[Need]] = frozenset()
    command: ClassVar[CommandKind] = "velocity"

    def __init__(self, config: PluginConfig | None = None) -> None:
        self.config: Any = config if config is not None else self.Config()

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:  # noqa: B027 - optional
        """Start the worlds ``rows`` (N,)."""

    @abstractmethod
    def steer(self, observation: Observation, guide: Guide) -> FloatArray:
        """(B, A, 2) commands."""
