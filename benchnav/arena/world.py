"""A drawn world: geometry, agents and clock of one episode before it starts.

A scenario generates it for one seed, the simulator steps it, and an episode
records it. It does not know its scenario.
"""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from benchnav.arena.agents import Agents
from benchnav.arena.body import Body
from benchnav.arena.mesh import Mesh
from benchnav.arena.sensing import Sensing
from benchnav.arena.solid import Kind, Solid
from benchnav.arrays import BoolArray, Extent, IntArray


class ContactRule(IntEnum):
    """The effect of a contact on an agent."""

    SLIDE = 0  # blocked along the contact normal, free along the tangent
    STOP = 1  # stands still until its next decision
    END = 2  # its attempt ends


class Afterwards(IntEnum):
    """The effect of arrival, or of the end of an attempt, on an agent's body."""

    VANISH = 0
    STAY = 1


class Charge(IntEnum):
    """Which agent is charged if an agent hits one that arrived or ended, and stayed."""

    HITTER = 0
    BOTH = 1


@dataclass(frozen=True)
class Clock:
    """Time [s]."""

    dt: float  # between decisions
    substeps: int  # integration steps within one decision
    steps: int  # decisions until the horizon
    decision_budget: float | None = None  # [s] allowed for a decision; scored, not enforced

    @property
    def horizon(self) -> float:
        """Duration of the episode [s]."""
        return self.steps * self.dt


@dataclass(frozen=True)
class Rules:
    """The conditions of arrival, and the effects of contacts."""

    goal_tolerance: float  # [m] between centre and goal
    contact: ContactRule
    on_arrival: Afterwards
    on_end: Afterwards
    charge: Charge


@dataclass(frozen=True, eq=False)
class World:
    """The complete input of the simulator for one episode."""

    bounds: Extent  # xmin, ymin, xmax, ymax [m]
    solids: tuple[Solid, ...]  # immobile within the episode; walls first
    bodies: tuple[Body, ...]  # dynamic obstacles, then static ones that are relocated within it
    agents: Agents
    teams: tuple[str, ...]
    sees: BoolArray  # (teams, teams): sees[i, j] is False if team i ignores team j
    clock: Clock
    rules: Rules
    sensing: Sensing
    stale_solids: tuple[Solid, ...] | None = (
        None  # the solids before they were moved; None: they were not moved
    )
    measurement_area: Extent | None = None  # the area of density measurements [m]
    meshes: tuple[Mesh, ...] = ()  # the meshes whose cross-sections are among the solids
    redraws: int = 0  # unsolvable draws that were rejected

    @property
    def people(self) -> tuple[IntArray, IntArray]:
        """The people: indices of agents (N,) and of bodies (K,), ascending.

        People are the agents that the evaluated navigator does not drive, and the obstacles that
        are recorded people.
        """
        agents = np.flatnonzero(~self.agents.evaluated)
        bodies = [m for m, body in enumerate(self.bodies) if body.person]
        return agents.astype(np.int64), np.array(bodies, np.int64)

    @property
    def has_people(self) -> bool:
        """Whether there are `people`."""
        return any(map(len, self.people))

    @property
    def relocates(self) -> bool:
        """Whether static geometry moves within the episode."""
        return any(body.solid.kind == Kind.STATIC for body in self.bodies)
