"""Navigators whose weights were learned: the paper's, and one that is free to see more."""

from typing import ClassVar

from benchnav.navigation.navigator import PluginConfig

from ...common.policy_runner import PilotedNavigator
from .policy_at_work import DriverConfig, pilot_of


class RecurrentPPO(PilotedNavigator):
    """The paper's method: PPO with LSTM, 7 forward rays, and velocity obstacles of what they meet.

    The policy sees by its rays alone, and what they meet is all that corrects it.
    Deterministic: the mean of the Gaussian over (forward speed, turn rate).
    """

    Config = DriverConfig
    shipped: ClassVar[str] = "recurrent-ppo.safetensors"

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self.pilot = pilot_of(self.config, self.shipped)


class RecurrentPPOPlus(RecurrentPPO):
    """RecurrentPPO that sees all round, told its neighbours' velocities, and steers smoothly."""

    shipped: ClassVar[str] = "recurrent-ppo-plus.safetensors"
