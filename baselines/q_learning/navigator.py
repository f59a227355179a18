"""A table over what is sensed, learned beforehand."""

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np
from pydantic import Field

from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.navigator import CommandKind, Navigator, Need, PluginConfig, Training
from benchnav.navigation.observation import Observation
from benchnav.navigation.row_table import RowTable

from .encoder import situations
from .moves import MOST_TURN, twists
from .table import load

SHIPPED = Path(__file__).parent / "weights" / "leaders.safetensors"


class QLearningConfig(PluginConfig):
    """Parameters."""

    table: Path | None = Field(
        None, description="file that training wrote (.safetensors); none: the one that ships"
    )


class Player:
    """The table at work in many rows, as a navigator's or a controller's."""

    def __init__(self, config: QLearningConfig) -> None:
        table = load(SHIPPED if config.table is None else config.table)
        self._policy, self._about = table.policy(), table.about
        self._told = RowTable()

    @property
    def training(self) -> Training:
        """What the table cost."""
        return Training(int(self._about["steps"]), float(self._about["seconds"]))

    @property
    def fingerprint(self) -> str:
        """Of the table."""
        return self._about["sha256"]

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        """Start the worlds ``rows`` (N,)."""
        for row, briefing in zip(rows, briefings, strict=True):
            self._told.put(
                int(row),
                speed=briefing.preferred_speed,
                turn=np.minimum(briefing.max_turn_rate, MOST_TURN),
                tolerance=np.full(len(briefing), briefing.goal_tolerance),
            )

    def kept(self, name: str, seen: Observation) -> FloatArray:
        """(B, A) speed, turn or tolerance of the agents in sight."""
        values: FloatArray = self._told.take(name, seen.rows, seen.active.shape[1])
        return values

    def twists(self, seen: Observation, tolerance: FloatArray) -> FloatArray:
        """(B, A, 2) the best move towards goals that have a ``tolerance`` (B, A) [m]."""
        speed, turn = self.kept("speed", seen), self.kept("turn", seen)
        return twists(self._policy[situations(seen, speed, tolerance)], speed, turn)


class QLearning(Navigator):
    """Looks up the best of fifteen moves for the situation that seven rays and the goal make.

    Tabular Q-learning (Watkins & Dayan 1992; Sutton & Barto 2018, section 6.5): no memory,
    no map, and no command between those of the table.
    """

    Config = QLearningConfig
    needs: ClassVar[frozenset[Need]] = frozenset({Need.RAYS})
    command: ClassVar[CommandKind] = "twist"

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self.player = Player(self.config)

    @property
    def training(self) -> Training:
        return self.player.training

    @property
    def fingerprint(self) -> str:
        return self.player.fingerprint

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        self.player.reset(briefings, rows)

    def act(self, observation: Observation) -> FloatArray:
        return self.player.twists(observation, self.player.kept("tolerance", observation))
