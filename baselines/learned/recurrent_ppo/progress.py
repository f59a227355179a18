"""How long agents have come no nearer to their goals."""

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.navigation import Briefing, Observation, RowTable

NEARER = 0.1  # [m] by which an agent has to come nearer


class Progress:
    """The least distance of agents from their goals, and the time since then."""

    def __init__(self) -> None:
        self._kept = RowTable()

    def reset(self, row: int, briefing: Briefing) -> None:
        """Forget all agents of the world ``row``."""
        agents = len(briefing)
        self._kept.put(
            row,
            goal=np.full((agents, 2), np.nan),
            least=np.full(agents, np.inf),
            stalled=np.zeros(agents),
            dt=np.full(agents, briefing.dt),
        )

    def stalled(self, observation: Observation) -> FloatArray:
        """Return the time (B, A) [s] since each agent came nearer to its goal, or got another."""
        rows, agents = observation.rows, observation.active.shape[1]
        goal, least, stalled, dt = (
            self._kept.take(name, rows, agents) for name in ("goal", "least", "stalled", "dt")
        )
        way = observation.goal - observation.position
        distance = np.sqrt(np.sum(way * way, axis=-1))
        other = np.any(goal != observation.goal, axis=-1)
        nearer = other | (distance < least - NEARER)
        stalled = np.where(nearer, 0.0, stalled + dt)
        self._kept.write("goal", rows, observation.goal)
        self._kept.write("least", rows, np.where(nearer, distance, least))
        self._kept.write("stalled", rows, stalled)
        return stalled
