"""When to plan again: the policies, and what is kept of one world to apply them."""

from typing import Literal

import numpy as np
from pydantic import Field

from benchnav.arrays import BoolArray, FloatArray
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.navigator import PluginConfig
from benchnav.navigation.randomness.agent_streams import agent_streams


class Every(PluginConfig):
    """Plan again at intervals."""

    every: float = Field(gt=0, description="[s] since an agent's last plan")


When = Literal["map-change", "blocked"] | Every
Replan = Literal["never"] | When | tuple[When, ...]


class Policies:
    """What is asked for, taken apart."""

    def __init__(self, replan: Replan) -> None:
        given = replan if isinstance(replan, tuple) else (replan,)
        intervals = [when.every for when in given if isinstance(when, Every)]
        self.never = given == ("never",) or not given
        self.map_change = "map-change" in given
        self.blocked = "blocked" in given
        self.interval = min(intervals, default=float("inf"))  # [s]


class Watch:
    """What is kept of one world to tell which of its agents plan again."""

    def __init__(self, briefing: Briefing) -> None:
        count = len(briefing)
        self.briefing = briefing
        self.streams = agent_streams(briefing)
        self.radius = briefing.radius.copy()  # (A,) [m] of the disc that the path is for
        self.solved = np.zeros(count, np.bool_)  # (A,) its last plan was
        self.blocked = np.zeros(count, np.bool_)  # (A,) its path was found to be
        self.looked = np.zeros(count, np.int64)  # (A,) version of the map that it was held against
        self.version = np.zeros(count, np.int64)  # (A,) of the map that was planned on
        self.planned = np.zeros(count)  # (A,) [s] when, last
        self._place = briefing.start.copy()  # (A, 2) [m] within a radius of which it has been
        self._since = np.zeros(count)  # (A,) [s] when it came there, or last asked
        self._tries = np.zeros(count, np.int64)  # (A,) how often it asked there

    def waited(self, position: FloatArray, time: float, patience: float, more: float) -> BoolArray:
        """(A,) True where an agent has been in one place for so long [s], then ``more`` times …"""
        offset = position - self._place
        left = np.sum(offset * offset, axis=1) > self.briefing.radius**2
        enough = patience * more**self._tries * (1.0 - 1e-9)
        long: BoolArray = ~left & (time - self._since >= enough)
        self._tries = np.where(left, 0, self._tries + long)
        self._place[left] = position[left]
        self._since[left | long] = time
        return long
