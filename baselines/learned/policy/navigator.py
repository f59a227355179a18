"""A policy that was trained with another library, as a navigator."""

from typing import ClassVar, get_args

from benchnav.navigation import DynamicsName, PluginConfig

from ...common.policy_runner import PilotedNavigator
from .loading import PolicyConfig
from .pilot import PolicyFilePilot


class PolicyNavigator(PilotedNavigator):
    """A policy of Stable-Baselines3, sb3-contrib (`.zip`) or any other library (`.onnx`).

    It learned in one of the learning environments; its actions are executed as they are there.
    Deterministic: without the noise of the training. Nothing in the file is unpickled.
    """

    Config = PolicyConfig
    drives: ClassVar[frozenset[DynamicsName]] = frozenset(get_args(DynamicsName))

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self.pilot = PolicyFilePilot(self.config)
