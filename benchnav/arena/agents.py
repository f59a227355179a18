"""The agents of one drawn world, as arrays over A."""

from dataclasses import dataclass
from enum import IntEnum

from benchnav.arrays import BoolArray, ByteArray, FloatArray, IntArray


class Dynamics(IntEnum):
    """What an agent's body can do with a command."""

    HOLONOMIC = 0
    UNICYCLE = 1


class Role(IntEnum):
    """Roles are scored apart."""

    LEADER = 0
    FOLLOWER = 1


@dataclass(frozen=True, eq=False)
class Agents:
    """Who starts where, wants what, and is driven by whom."""

    start: FloatArray  # (A, 2) [m]
    heading: FloatArray  # (A,) [rad] at the start
    goal: FloatArray  # (A, 2) [m]
    radius: FloatArray  # (A,) [m]
    max_speed: FloatArray  # (A,) [m/s]
    preferred_speed: FloatArray  # (A,) [m/s]
    max_turn_rate: FloatArray  # (A,) [rad/s], used by unicycles
    dynamics: ByteArray  # (A,) of Dynamics
    role: ByteArray  # (A,) of Role
    team: IntArray  # (A,) index into the world's team names
    driver: IntArray  # (A,) 0: the evaluated navigator; k > 0: background driver k - 1

    def __len__(self) -> int:
        return len(self.radius)

    @property
    def evaluated(self) -> BoolArray:
        """(A,) True for the agents that the evaluated navigator drives."""
        mine: BoolArray = self.driver == 0
        return mine
