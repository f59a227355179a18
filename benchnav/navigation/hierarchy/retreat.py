"""Giving way: an agent that is stuck goes back the way it came for a while.

Two agents that meet in a door wait for each other forever if both stay, and meet again if
both leave. So each agent draws whether it goes back and for how long, as stations on a
shared line do after a collision (Metcalfe & Boggs 1976).
"""

import numpy as np

from benchnav.arrays import BoolArray, FloatArray

SPACING = 0.5  # [m] between remembered places
PLACES = 16
LEAST, MOST = 2.0, 6.0  # [s] of going back


class Retreat:
    """The past places of the agents of one world, and the agents that go back along them."""

    def __init__(self, start: FloatArray) -> None:
        count = len(start)
        self._crumb = np.repeat(start[:, None], PLACES, axis=1)  # (A, PLACES, 2) [m], newest first
        self.until = np.full(count, -np.inf)  # (A,) [s] end of the retreat

    def note(self, place: FloatArray, time: float) -> None:
        """Remember the places (A, 2) [m] of the agents that do not go back."""
        offset = place - self._crumb[:, 0]
        far = np.sum(offset * offset, axis=1) > SPACING * SPACING
        far &= ~self.going(time)
        self._crumb[far, 1:] = self._crumb[far, :-1]
        self._crumb[far, 0] = place[far]

    def going(self, time: float) -> BoolArray:
        """Return (A,), True for agents that go back now."""
        now: BoolArray = time < self.until * (1.0 - 1e-9)
        return now

    def begin(
        self, agent: int, place: FloatArray, time: float, rng: np.random.Generator
    ) -> FloatArray:
        """Start a retreat of random duration. Return the way back (W, 2) [m]."""
        self.until[agent] = time + rng.uniform(LEAST, MOST)
        return np.vstack([place, self._crumb[agent]])
