"""Cars that have no way ahead drive backwards for a while."""

from collections.abc import Sequence

import numpy as np

from benchnav.arena import Dynamics
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.navigation import Briefing, Observation, RowTable

STANDING = 0.1  # [m/s] a slower car counts as standing
PATIENCE = 1.0  # [s] of standing before a car drives backwards
BACK = 2.0  # [s] for which it does


class Backing:
    """Decides when cars that can drive backwards do so because they stand."""

    def __init__(self) -> None:
        self._table = RowTable()

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        """Start the worlds ``rows`` (N,)."""
        for row, briefing in zip(rows.tolist(), briefings, strict=True):
            able = briefing.reverse & (briefing.dynamics == Dynamics.ACKERMANN)
            since, until = np.zeros(len(briefing)), np.full(len(briefing), -np.inf)
            self._table.put(row, able=able, since=since, until=until)

    def decide(self, observation: Observation, speed: FloatArray) -> BoolArray:
        """Return whether each car drives backwards now, (B, A).

        Args:
            observation: of one decision.
            speed: (B, A) [m/s] the last one, < 0 backwards.
        """
        rows, agents = observation.rows, observation.active.shape[1]
        able, since, until = (
            self._table.take(name, rows, agents) for name in ("able", "since", "until")
        )
        time = observation.time[:, None]
        since = np.where(np.abs(speed) < STANDING, since, time)
        tired = able & (time - since >= PATIENCE) & (time >= until)
        until = np.where(tired, time + BACK, until)
        since = np.where(tired, until, since)
        self._table.write("since", rows, since)
        self._table.write("until", rows, until)
        backing: BoolArray = able & (time < until)
        return backing
