"""The table at work in many rows."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from pydantic import Field

from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.navigator import Need, PluginConfig, Training
from benchnav.navigation.observation import Observation
from benchnav.navigation.row_table import RowTable

from ...common.policy_runner import Pilot
from .encoder import situations
from .moves import MOST_TURN, twists
from .table import load

SHIPPED = Path(__file__).parent / "weights" / "leaders.safetensors"


class QLearningConfig(PluginConfig):
    """Parameters."""

    table: Path | None = Field(
        None, description="file that training wrote (.safetensors); none: the one that ships"
    )


class TablePilot(Pilot):
    """The greedy policy of the table."""

    def __init__(self, config: QLearningConfig) -> None:
        table = load(SHIPPED if config.table is None else config.table)
        self._policy, self._about = table.policy(), table.about
        self._told = RowTable()

    @property
    def needs(self) -> frozenset[Need]:
        return frozenset({Need.RAYS})

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

    def tolerance(self, seen: Observation) -> FloatArray:
        return self._kept("tolerance", seen)

    def twists(self, seen: Observation, tolerance: FloatArray) -> FloatArray:
        speed, turn = self._kept("speed", seen), self._kept("turn", seen)
        return twists(self._policy[situations(seen, speed, tolerance)], speed, turn)

    def _kept(self, name: str, seen: Observation) -> FloatArray:
        values: FloatArray = self._told.take(name, seen.rows, seen.active.shape[1])
        return values
