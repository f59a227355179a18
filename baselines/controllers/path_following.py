"""Pure pursuit: straight to the guide's target (Coulter 1992), without avoidance."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation import Briefing, Controller, Guide, Observation, PluginConfig, RowTable

from ..common.approach import approach


class PathFollowing(Controller):
    """Drives along its path at preferred speed, slower only to stop at its end."""

    cut: ClassVar[float] = 0.03  # it does not sense the corners that it cuts

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._table = RowTable()

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        for row, briefing in zip(rows, briefings, strict=True):
            step = np.full(len(briefing), briefing.dt)
            self._table.put(int(row), speed=briefing.preferred_speed, dt=step)

    def steer(self, observation: Observation, guide: Guide) -> FloatArray:
        rows, agents = observation.rows, observation.active.shape[1]
        speed, dt = (self._table.take(name, rows, agents) for name in ("speed", "dt"))
        return approach(observation.position, guide.target, speed, dt)
