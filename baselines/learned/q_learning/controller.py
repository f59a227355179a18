"""The controller `q-learning`: a learned Q-table drives to the waypoints of a planner."""

from benchnav.navigation import PluginConfig

from ...common.policy_runner import PilotedController
from .table_pilot import QLearningConfig, TablePilot


class QLearningController(PilotedController):
    """The table of `q-learning`, with the guide's target as its goal."""

    Config = QLearningConfig

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self.pilot = TablePilot(self.config)
