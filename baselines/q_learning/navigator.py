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


class QLearning(Navigator):
    """Looks up the best of fifteen moves for the situation that seven rays and the goal make.

    Tabular Q-learning (Watkins & Dayan 1992; Sutton & Barto 2018, section 6.5): no memory,
    no map, and no command between those of the table.
    """

    class Config(PluginConfig):
        """Parameters."""

        table: Path | None = Field(
            None, description="file that training wrote (.safetensors); none: the one that ships"
        )

    needs: ClassVar[frozenset[Need]] = frozenset({Need.RAYS})
    command: ClassVar[CommandKind] = "twist"

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        table = load(SHIPPED if self.config.table is None else self.config.table)
        self._policy, self._about = table.policy(), table.about
        self._told = RowTable()

    @property
    def training(self) -> Training:
        return Training(int(self._about["steps"]), float(self._about["seconds"]))

    @property
    def fingerprint(self) -> str:
        return self._about["sha256"]

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        for row, briefing in zip(rows, briefings, strict=True):
            self._told.put(
                int(row),
                speed=briefing.preferred_speed,
                turn=np.minimum(briefing.max_turn_rate, MOST_TURN),
                tolerance=np.full(len(briefing), briefing.goal_tolerance),
            )

    def act(self, observation: Observation) -> FloatArray:
        rows, agents = observation.rows, observation.active.shape[1]
        speed = self._told.take("speed", rows, agents)
        turn, tolerance = (self._told.take(name, rows, agents) for name in ("turn", "tolerance"))
        move = self._policy[situations(observation, speed, tolerance)]
        return twists(move, speed, turn)
