"""Navigators whose weights were learned: the paper's, and one that is free to see more."""

from collections.abc import Sequence
from typing import ClassVar

from benchnav.arena.sensing import Sensing
from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.navigator import CommandKind, Navigator, Need, PluginConfig, Training
from benchnav.navigation.observation import Observation

from .pilot import SHIPPED, ForesightConfig, PilotConfig, pilot_of

__all__ = ["SHIPPED", "RecurrentPPO", "RecurrentPPOPlus"]


class RecurrentPPO(Navigator):
    """The paper's method: PPO with LSTM and collision prediction, 7 forward rays.

    Deterministic: the mean of the Gaussian over (forward speed, turn rate).
    """

    Config = PilotConfig
    command: ClassVar[CommandKind] = "twist"
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

    def act(self, observation: Observation) -> FloatArray:
        return self.pilot.twists(observation, self.pilot.kept("tolerance", observation))


class RecurrentPPOPlus(RecurrentPPO):
    """RecurrentPPO that sees all round, told its neighbours' velocities, and steers smoothly."""

    Config = ForesightConfig
    shipped: ClassVar[str] = "recurrent-ppo-plus.safetensors"
