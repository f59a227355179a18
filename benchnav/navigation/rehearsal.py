"""The information about a rehearsal: the paths of the leaders, and the outcome for each.

The runner makes rehearsals before the scored episode, for navigators that declare the
grant; a navigator never simulates the world itself.
"""

from dataclasses import dataclass, replace

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Rehearsal:
    """One run of the L leaders in the world of the briefing, with new phases of the movers.

    Obstacles that are re-placed within the scored episode keep their first places. In a
    team without a leader, the member nearest to the team's middle leads.
    """

    dt: float  # [s] between positions
    agent: IntArray  # (L,) the leaders, as indices into the agents of the briefing
    position: FloatArray  # (T+1, L, 2) [m]
    last: IntArray  # (L,) index of the last position of each leader's attempt
    arrival: FloatArray  # (L,) [s], NaN for a leader that did not arrive
    collided: BoolArray  # (L,) charged with a collision

    def __len__(self) -> int:
        return len(self.agent)

    @property
    def succeeded(self) -> BoolArray:
        """(L,) True for leaders that arrived without a collision."""
        arrived: BoolArray = ~np.isnan(self.arrival)
        return arrived & ~self.collided

    def trajectory(self, leader: int) -> FloatArray:
        """Return the positions (last+1, 2) [m] of a leader (its index) during its attempt."""
        way: FloatArray = self.position[: self.last[leader] + 1, leader]
        return way


def copied(rehearsal: Rehearsal) -> Rehearsal:
    """Return an equal rehearsal with copies of the arrays."""
    arrays = ("agent", "position", "last", "arrival", "collided")
    return replace(rehearsal, **{name: getattr(rehearsal, name).copy() for name in arrays})
