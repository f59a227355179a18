"""Giving way: an agent that is stuck goes back the way it came for a while.

Two that meet in a door wait for each other for ever if both insist, and meet again if
both leave; so each draws whether it goes, and for how long, as stations on a shared
line do after a collision (Metcalfe & Boggs 1976).
"""

import numpy as np

from benchnav.arrays import BoolArray, FloatArray

SPACING = 0.5  # [m] between remembered places
PLACES = 16
LEAST, MOST = 2.0, 6.0  # [s] of going back


class Retreat:
    """Where the agents of one world came from, and who is going back there."""

    def __init__(self, start: FloatArray) -> None:
        count = len(start)
        self._crumb = np.repeat(start[:, None], PLACES, axis=1)  # (A, PLACES, 2) [m], newest first
        self.until = np.full(count, -np.inf)  # (A,) [s] until when it goes back

    def note(self, place: FloatArray, time: float) -> None:
        """Remember where those who do not go back are (A, 2) [m]."""
        offset = place - self._crumb[:, 0]
        far = np.sum(offset * offset, axis=1) > SPACING * SPACING
        far &= ~self.going(time)
        self._crumb[far, 1:] = self._crumb[far, :-1]
        self._crumb[far, 0] = place[far]

    def going(self, time: float) -> BoolArray:
        """(A,) who is going back now."""
        now: BoolArray = time < self.until * (1.0 - 1e-9)
        return now

    def begin(
        self, agent: int, place: FloatArray, time: float, rng: np.random.Generator
    ) -> FloatArray:
        """The way back (W, 2) [m], for a time that is drawn."""
        self.until[agent] = time + rng.uniform(LEAST, MOST)
        return np.vstack([place, self._crumb[agent]])
