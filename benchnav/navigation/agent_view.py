"""One agent's part of an observation."""

from dataclasses import dataclass
from typing import Any

from benchnav.arrays import FloatArray
from benchnav.navigation.map import Map
from benchnav.navigation.observation import Observation
from benchnav.sensors.readings import Edges, Rays


@dataclass(frozen=True, eq=False, kw_only=True)
class AgentView:
    """The perception of one agent now, in the world frame (noisy: in its odometry frame).

    Keep memory in ``state``. To keep it elsewhere, use (``row``, ``agent``) as its key:
    ``batch_index`` changes from call to call, because worlds that have ended are left out.
    """

    time: float  # [s] since the episode began
    position: FloatArray  # (2,) [m]
    heading: float  # [rad]
    velocity: FloatArray  # (2,) [m/s] as executed in the last step
    goal: FloatArray  # (2,) [m]
    row: int  # number of the world from `reset` to the end of its episode
    agent: int  # index of the agent in the arrays of the briefing
    state: Any  # what `reset_agent` returned for this agent
    observation: Observation  # the batch from which this view is taken
    batch_index: int  # index of the world in the arrays of ``observation``, in this call only

    @property
    def neighbours(self) -> list[tuple[FloatArray, FloatArray, float]]:
        """(position, velocity, radius) of each sensed neighbour, nearest first."""
        sensed = self.observation.neighbours
        if sensed is None:
            return []
        at = self._at
        return [
            (sensed.position[at][k], sensed.velocity[at][k], float(sensed.radius[at][k]))
            for k in range(int(sensed.count[at]))
        ]

    @property
    def rays(self) -> Rays | None:
        """The rays of this agent: arrays (R,), one radius. None if it does not need rays."""
        sensed, at = self.observation.rays, self._at
        if sensed is None:
            return None
        return Rays(
            sensed.angle, sensed.distance[at], sensed.kind[at], sensed.approach[at],
            sensed.goal[at], sensed.radius[at], sensed.across[at],
        )  # fmt: skip

    @property
    def edges(self) -> Edges | None:
        """The edges that this agent sees: each array starts with (count,). None if not needed."""
        sensed, at = self.observation.edges, self._at
        if sensed is None:
            return None
        seen = (*at, slice(int(sensed.count[at])))
        return Edges(
            sensed.start[seen], sensed.end[seen], sensed.before[seen], sensed.after[seen],
            sensed.start_convex[seen], sensed.end_convex[seen], sensed.count[at],
        )  # fmt: skip

    @property
    def steering(self) -> float:
        """The steering angle [rad] of an Ackermann body, positive to the left; 0 for others."""
        return float(self.observation.steering[self._at])

    @property
    def map(self) -> Map | None:
        """The map that the track grants now."""
        return self.observation.maps[self.batch_index]

    @property
    def _at(self) -> tuple[int, int]:
        return self.batch_index, self.agent
