"""A table over sensor readings, learned beforehand."""

from benchnav.navigation import PluginConfig

from ...common.policy_runner import PilotedNavigator
from .table_pilot import QLearningConfig, TablePilot


class QLearning(PilotedNavigator):
    """Looks up the best of fifteen moves for the situation of seven rays and the goal.

    Tabular Q-learning (Watkins & Dayan 1992; Sutton & Barto 2018, section 6.5): no memory,
    no map, and only the commands of the table.
    """

    Config = QLearningConfig

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self.pilot = TablePilot(self.config)
