"""A lower bound: straight to the goal, without avoidance."""

from collections.abc import Sequence

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation import Briefing, Navigator, Observation, PluginConfig, RowTable

from ..common.approach import approach


class StraightLine(Navigator):
    """Drives straight to its goal at preferred speed."""

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._table = RowTable()

    @property
    def uses_map(self) -> bool:
        return False

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        for row, briefing in zip(rows, briefings, strict=True):
            step = np.full(len(briefing), briefing.dt)
            self._table.put(int(row), speed=briefing.preferred_speed, dt=step)

    def act(self, observation: Observation) -> FloatArray:
        rows, agents = observation.rows, observation.active.shape[1]
        speed, dt = (self._table.take(name, rows, agents) for name in ("speed", "dt"))
        return approach(observation.position, observation.goal, speed, dt)
