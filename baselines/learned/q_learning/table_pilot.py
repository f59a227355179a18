"""The table as a pilot of many rows."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from pydantic import Field

from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation import Briefing, Need, Observation, PluginConfig, RowTable, Training

from ...common.policy_runner import Pilot
from .encoder import situations
from .moves import MAX_TURN, twists
from .table import load

SHIPPED = Path(__file__).parent / "weights" / "leaders.safetensors"


class QLearningConfig(PluginConfig):
    """Parameters."""

    table: Path | None = Field(
        None, description="table file of a training (.safetensors); none: the included table"
    )


class TablePilot(Pilot):
    """The greedy policy of the table."""

    def __init__(self, config: QLearningConfig) -> None:
        table = load(SHIPPED if config.table is None else config.table)
        self._policy, self._about = table.policy(), table.about
        self._table = RowTable()

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
            self._table.put(
                int(row),
                speed=briefing.preferred_speed,
                turn=np.minimum(briefing.max_turn_rate, MAX_TURN),
                tolerance=np.full(len(briefing), briefing.goal_tolerance),
            )

    def tolerance(self, observation: Observation) -> FloatArray:
        return self._kept("tolerance", observation)

    def twists(self, observation: Observation, tolerance: FloatArray) -> FloatArray:
        speed, turn = self._kept("speed", observation), self._kept("turn", observation)
        return twists(self._policy[situations(observation, speed, tolerance)], speed, turn)

    def _kept(self, name: str, observation: Observation) -> FloatArray:
        values: FloatArray = self._table.take(name, observation.rows, observation.active.shape[1])
        return values
