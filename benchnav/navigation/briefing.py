"""The briefing: information about one world before an episode, for the agents of a navigator."""

from dataclasses import dataclass

import numpy as np

from benchnav.arena.agent_bodies import PLAIN_BODY, AgentBodies
from benchnav.arena.agents import Agents
from benchnav.arrays import ByteArray, FloatArray, IntArray
from benchnav.navigation.map import Map
from benchnav.navigation.rehearsal import Rehearsal


@dataclass(frozen=True, eq=False)
class Briefing(AgentBodies):
    """Roles, goals, limits, clock, and the map that the track grants.

    It does not name the scenario, the split or the seed. The generator is the only source of
    randomness that a navigator may use. It is seeded with a salt of the run, which no
    navigator receives, so trying seeds does not reveal the world. Starts, goals and sizes
    are visible and may reveal it.
    """

    dt: float  # [s] between decisions
    horizon: float  # [s] after which the episode ends
    goal_tolerance: float  # [m] from the goal at which an agent has arrived
    decision_budget: float | None  # [s] per decision and world, None if there is none
    start: FloatArray  # (A, 2) [m]
    heading: FloatArray  # (A,) [rad]
    goal: FloatArray  # (A, 2) [m]
    radius: FloatArray  # (A,) [m] of the disc, or of the circle around the footprint
    max_speed: FloatArray  # (A,) [m/s]
    preferred_speed: FloatArray  # (A,) [m/s]
    max_turn_rate: FloatArray  # (A,) [rad/s]
    dynamics: ByteArray  # (A,) of Dynamics
    role: ByteArray  # (A,) of Role
    team: IntArray  # (A,) number of the team; agents of one team share it
    map: Map | None  # as the track grants it; None in the track `unknown`
    rng: np.random.Generator  # the only source of randomness
    rehearsals: tuple[Rehearsal, ...] = ()  # leaders' earlier runs, if the navigator requests any

    def __len__(self) -> int:
        return len(self.radius)


def brief(
    agents: Agents,
    chosen: IntArray,
    *,
    dt: float,
    horizon: float,
    goal_tolerance: float,
    decision_budget: float | None,
    map: Map | None,
    rng: np.random.Generator,
    rehearsals: tuple[Rehearsal, ...] = (),
) -> Briefing:
    """Return the briefing of the agents ``chosen`` (indices into the world's agents)."""

    def copy(array: FloatArray | IntArray | ByteArray) -> np.ndarray:
        return array[chosen].copy()

    return Briefing(
        dt, horizon, goal_tolerance, decision_budget,
        copy(agents.start), copy(agents.heading), copy(agents.goal), copy(agents.radius),
        copy(agents.max_speed), copy(agents.preferred_speed), copy(agents.max_turn_rate),
        copy(agents.dynamics), copy(agents.role), copy(agents.team), map, rng,
        rehearsals, **{name: copy(getattr(agents, name)) for name in PLAIN_BODY},
    )  # fmt: skip
