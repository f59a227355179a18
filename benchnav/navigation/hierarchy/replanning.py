"""When to plan again: the policies, and the state of one world to apply them."""

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
    """The replanning policies of a configuration."""

    def __init__(self, replan: Replan) -> None:
        given = replan if isinstance(replan, tuple) else (replan,)
        intervals = [when.every for when in given if isinstance(when, Every)]
        self.never = given == ("never",) or not given
        self.map_change = "map-change" in given
        self.blocked = "blocked" in given
        self.interval = min(intervals, default=float("inf"))  # [s]


class Watch:
    """The state of one world that decides which of its agents plan again."""

    def __init__(self, briefing: Briefing) -> None:
        count = len(briefing)
        self.briefing = briefing
        self.streams = agent_streams(briefing)
        self.radius = briefing.radius.copy()  # (A,) [m] of the disc that the path is for
        self.solved = np.zeros(count, np.bool_)  # (A,) whether the last plan is solved
        self.blocked = np.zeros(count, np.bool_)  # (A,) whether the path is blocked
        self.looked = np.zeros(count, np.int64)  # (A,) version of the last map it was checked on
        self.version = np.zeros(count, np.int64)  # (A,) version of the map of the last plan
        self.planned = np.zeros(count)  # (A,) [s] time of the last plan
        self._place = briefing.start.copy()  # (A, 2) [m] the agent stayed within its radius of it
        self._since = np.zeros(count)  # (A,) [s] time of arrival there, or of the last wait's end
        self._tries = np.zeros(count, np.int64)  # (A,) number of waits that ended there

    def waited(self, position: FloatArray, time: float, patience: float, more: float) -> BoolArray:
        """Return (A,), True for agents that were in one place for ``patience`` [s].

        Each further wait in the same place is ``more`` times as long as the one before.
        """
        offset = position - self._place
        left = np.sum(offset * offset, axis=1) > self.briefing.radius**2
        enough = patience * more**self._tries * (1.0 - 1e-9)
        long: BoolArray = ~left & (time - self._since >= enough)
        self._tries = np.where(left, 0, self._tries + long)
        self._place[left] = position[left]
        self._since[left | long] = time
        return long
