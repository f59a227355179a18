"""Navigators with learned weights: the paper's, and one with more sensors."""

from typing import ClassVar

from benchnav.navigation import PluginConfig

from ...common.policy_runner import PilotedNavigator
from .policy_at_work import DriverConfig, pilot_of


class RecurrentPPO(PilotedNavigator):
    """The paper's method: PPO with LSTM, 7 forward rays, and velocity obstacles of their hits.

    The policy senses by its rays only, and only what they hit corrects it.
    Deterministic: the mean of the Gaussian over (forward speed, turn rate).
    """

    Config = DriverConfig
    shipped: ClassVar[str] = "recurrent-ppo.safetensors"

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self.pilot = pilot_of(self.config, self.shipped)


class RecurrentPPOPlus(RecurrentPPO):
    """RecurrentPPO with a view all round and neighbours' velocities, which steers smoothly."""

    shipped: ClassVar[str] = "recurrent-ppo-plus.safetensors"
