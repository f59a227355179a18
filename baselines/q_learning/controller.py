"""The table as a controller: it is shown waypoints in place of its goal."""

from collections.abc import Sequence
from typing import ClassVar

from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.controller import Controller, Guide
from benchnav.navigation.navigator import CommandKind, Need, PluginConfig, Training
from benchnav.navigation.observation import Observation

from ..waypoint import towards
from .navigator import Player, QLearningConfig


class QLearningController(Controller):
    """The table of `q-learning`, shown the guide's target as its goal."""

    Config = QLearningConfig
    needs: ClassVar[frozenset[Need]] = frozenset({Need.RAYS})
    command: ClassVar[CommandKind] = "twist"
    lookahead: ClassVar[float] = 3.0

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self.player = Player(self.config)

    @property
    def training(self) -> Training:
        return self.player.training

    @property
    def fingerprint(self) -> str:
        return self.player.fingerprint

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        self.player.reset(briefings, rows)

    def steer(self, observation: Observation, guide: Guide) -> FloatArray:
        tolerance = self.player.kept("tolerance", observation)
        return self.player.twists(*towards(observation, guide, tolerance))
