"""The learned navigators as controllers: the policy follows waypoints in place of its goal."""

from collections.abc import Sequence
from typing import ClassVar

from benchnav.arena.sensing import Sensing
from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.controller import Controller, Guide
from benchnav.navigation.navigator import CommandKind, Need, PluginConfig, Training
from benchnav.navigation.observation import Observation

from ..waypoint import towards
from .pilot import ForesightConfig, PilotConfig, pilot_of


class RecurrentPPOController(Controller):
    """The policy of `recurrent-ppo`, shown the guide's target as its goal (`..waypoint`)."""

    Config = PilotConfig
    command: ClassVar[CommandKind] = "twist"
    lookahead: ClassVar[float] = 3.0
    shipped: ClassVar[str] = "recurrent-ppo.safetensors"

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self.pilot = pilot_of(self.config, self.shipped)

    @property
    def required(self) -> frozenset[Need]:
        return self.pilot.needs

    @property
    def training(self) -> Training:
        return self.pilot.training

    @property
    def fingerprint(self) -> str:
        return self.pilot.fingerprint

    def unfit(self, sensing: Sensing) -> str:
        return self.pilot.unfit(sensing)

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        self.pilot.reset(briefings, rows)

    def steer(self, observation: Observation, guide: Guide) -> FloatArray:
        tolerance = self.pilot.kept("tolerance", observation)
        return self.pilot.twists(*towards(observation, guide, tolerance))


class RecurrentPPOPlusController(RecurrentPPOController):
    """The policy of `recurrent-ppo-plus`, shown the guide's target as its goal."""

    Config = ForesightConfig
    shipped: ClassVar[str] = "recurrent-ppo-plus.safetensors"
