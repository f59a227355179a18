"""A table over what is sensed, learned beforehand."""

from benchnav.navigation.navigator import PluginConfig

from ...common.policy_runner import PilotedNavigator
from .table_pilot import QLearningConfig, TablePilot


class QLearning(PilotedNavigator):
    """Looks up the best of fifteen moves for the situation that seven rays and the goal make.

    Tabular Q-learning (Watkins & Dayan 1992; Sutton & Barto 2018, section 6.5): no memory,
    no map, and no command between those of the table.
    """

    Config = QLearningConfig

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self.pilot = TablePilot(self.config)
