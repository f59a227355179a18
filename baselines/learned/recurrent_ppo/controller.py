"""The learned navigators as controllers, with waypoints in place of their goals."""

from typing import ClassVar

from benchnav.navigation import PluginConfig

from ...common.policy_runner import PilotedController
from .policy_at_work import CorrectedConfig, PolicyConfig, pilot_of


class RecurrentPPOController(PilotedController):
    """The policy of `recurrent-ppo`, with the guide's target as its goal."""

    Config = PolicyConfig
    shipped: ClassVar[str] = "recurrent-ppo.safetensors"
    agents_behind: ClassVar[bool] = False  # see `PolicyPilot`

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self.pilot = pilot_of(self.config, self.shipped, self.agents_behind)


class RecurrentPPOVOController(RecurrentPPOController):
    """The policy of `recurrent-ppo` with the correction of `recurrent-ppo-vo`."""

    Config = CorrectedConfig


class RecurrentPPOPlusController(RecurrentPPOVOController):
    """The policy and the correction of `recurrent-ppo-plus`, without its detours."""

    shipped: ClassVar[str] = "recurrent-ppo-plus.safetensors"
