"""What a navigator is told of a rehearsal: where the leaders went, and how it ended for each.

The runner makes rehearsals before the scored episode, for navigators that declare the
grant; a navigator never simulates the world itself.
"""

from dataclasses import dataclass, replace

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Rehearsal:
    """One run of the L leaders in the world of the briefing, the movers' phases redrawn.

    Obstacles that are re-placed within the scored episode stand where it begins. Where a
    team has no leader, the member nearest to its middle led.
    """

    dt: float  # [s] between positions
    agent: IntArray  # (L,) who led: places among the agents of the briefing
    position: FloatArray  # (T+1, L, 2) [m]
    last: IntArray  # (L,) place of the last position of each leader's attempt
    arrival: FloatArray  # (L,) [s], NaN where it never came
    collided: BoolArray  # (L,) charged with a collision

    def __len__(self) -> int:
        return len(self.agent)

    @property
    def succeeded(self) -> BoolArray:
        """(L,) True for leaders that arrived without a collision."""
        came: BoolArray = ~np.isnan(self.arrival)
        return came & ~self.collided

    def trajectory(self, leader: int) -> FloatArray:
        """(last+1, 2) [m] where the leader in this place was until its attempt was over."""
        way: FloatArray = self.position[: self.last[leader] + 1, leader]
        return way


def copied(rehearsal: Rehearsal) -> Rehearsal:
    """The same, in arrays of its own."""
    arrays = ("agent", "position", "last", "arrival", "collided")
    return replace(rehearsal, **{name: getattr(rehearsal, name).copy() for name in arrays})
