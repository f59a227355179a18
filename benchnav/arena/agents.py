"""The agents of one drawn world, as arrays over A."""

from dataclasses import dataclass
from enum import IntEnum

from benchnav.arena.agent_bodies import AgentBodies
from benchnav.arrays import BoolArray, ByteArray, FloatArray, IntArray


class Dynamics(IntEnum):
    """The kinematics of an agent's body."""

    HOLONOMIC = 0
    UNICYCLE = 1
    DIFFERENTIAL_DRIVE = 2
    ACKERMANN = 3


class Role(IntEnum):
    """The role of an agent; roles are scored separately."""

    LEADER = 0
    FOLLOWER = 1


@dataclass(frozen=True, eq=False)
class Agents(AgentBodies):
    """Starts, goals, bodies and drivers of the agents."""

    start: FloatArray  # (A, 2) [m]
    heading: FloatArray  # (A,) [rad] at the start
    goal: FloatArray  # (A, 2) [m]
    radius: FloatArray  # (A,) [m] of the disc, or of the circle around the footprint
    max_speed: FloatArray  # (A,) [m/s]
    preferred_speed: FloatArray  # (A,) [m/s]
    max_turn_rate: FloatArray  # (A,) [rad/s], not used by planar velocities
    dynamics: ByteArray  # (A,) of Dynamics
    role: ByteArray  # (A,) of Role
    team: IntArray  # (A,) index into the world's team names
    driver: IntArray  # (A,) 0: the evaluated navigator; k > 0: background driver k - 1

    def __len__(self) -> int:
        return len(self.radius)

    @property
    def evaluated(self) -> BoolArray:
        """(A,) True for the agents of the evaluated navigator."""
        evaluated: BoolArray = self.driver == 0
        return evaluated
