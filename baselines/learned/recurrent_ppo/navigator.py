"""Navigators with learned weights: the paper's, alone or corrected, and one that sees more."""

from typing import ClassVar

from benchnav.navigation import PluginConfig

from ...common.policy_runner import PilotedNavigator
from .policy_at_work import DriverConfig, PolicyConfig, pilot_of


class RecurrentPPO(PilotedNavigator):
    """The paper's method as printed: PPO with LSTM, and 7 forward rays.

    The policy drives alone; predicted collisions are only a part of the reward of its training.
    Deterministic: the mean of the Gaussian over (forward speed, turn rate).
    """

    Config = PolicyConfig
    shipped: ClassVar[str] = "recurrent-ppo.safetensors"

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self.pilot = pilot_of(self.config, self.shipped)


class RecurrentPPOVO(RecurrentPPO):
    """A hybrid: the policy of `recurrent-ppo`, corrected by velocity obstacles and detours.

    The policy and its correction use the same senses: only what the rays hit corrects a command.
    """

    Config = DriverConfig


class RecurrentPPOPlus(RecurrentPPOVO):
    """A hybrid: a policy with a view all round, corrected by velocity obstacles and detours.

    It perceives neighbours with their velocities, and steers smoothly. With
    `foresight: false, patience: 0`, its policy drives alone.
    """

    shipped: ClassVar[str] = "recurrent-ppo-plus.safetensors"
