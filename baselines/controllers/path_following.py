"""Pure pursuit: straight at the guide's target (Coulter 1992), whatever is in the way."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.controller import Controller, Guide
from benchnav.navigation.navigator import PluginConfig
from benchnav.navigation.observation import Observation
from benchnav.navigation.row_table import RowTable

from ..common.approach import approach


class PathFollowing(Controller):
    """Drives along its path at preferred speed, slower only to stop at its end."""

    cut: ClassVar[float] = 0.03  # it does not see the corners that it cuts

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._told = RowTable()

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        for row, briefing in zip(rows, briefings, strict=True):
            step = np.full(len(briefing), briefing.dt)
            self._told.put(int(row), speed=briefing.preferred_speed, dt=step)

    def steer(self, observation: Observation, guide: Guide) -> FloatArray:
        rows, agents = observation.rows, observation.active.shape[1]
        speed, dt = (self._told.take(name, rows, agents) for name in ("speed", "dt"))
        return approach(observation.position, guide.target, speed, dt)
