"""The observation of the agents of one navigator, for a batch of worlds.

Arrays start with (B, A): the worlds of this call and the agents that this
navigator drives, padded; all other agents are neighbours. World frame; in the perception
track `noisy`, the odometry frame of each agent. Sensors that the navigator does not need are None.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.navigation.map import Map
from benchnav.sensors.readings import Edges, Neighbours, Rays, Rows

_ZERO: Any = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Observation(Rows):
    """The perception of a navigator's agents at one decision, in all worlds of the batch."""

    rows: IntArray  # (B,) the row that `reset` gave each world
    time: FloatArray  # (B,) [s]
    active: BoolArray  # (B, A) True if the command counts; False for padding and ended attempts
    position: FloatArray  # (B, A, 2) [m]
    heading: FloatArray  # (B, A) [rad]
    velocity: FloatArray  # (B, A, 2) [m/s] as executed in the last step
    goal: FloatArray  # (B, A, 2) [m]
    steering: FloatArray = _ZERO  # (B, A) [rad] of an Ackermann body's wheels, to the left; else 0
    maps: tuple[Map | None, ...]  # (B,) as the track grants it now
    rays: Rays | None = None  # None if the navigator does not need rays
    neighbours: Neighbours | None = None  # None if the navigator does not need neighbours
    edges: Edges | None = None  # None if the navigator does not need edges

    def __post_init__(self) -> None:
        if self.steering is None:
            object.__setattr__(self, "steering", np.zeros(self.heading.shape))

    def __len__(self) -> int:
        return len(self.rows)
