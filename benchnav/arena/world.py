"""A drawn world: concrete geometry, agents and clock of one episode, before it starts.

It is what a scenario generates for one seed, what the simulator steps, and what
an episode records. It does not know which scenario it came from.
"""

from dataclasses import dataclass
from enum import IntEnum

from benchnav.arena.agents import Agents
from benchnav.arena.body import Body
from benchnav.arena.mesh import Mesh
from benchnav.arena.sensing import Sensing
from benchnav.arena.solid import Kind, Solid
from benchnav.arrays import BoolArray


class ContactRule(IntEnum):
    """What touching something does to an agent."""

    SLIDE = 0  # blocked along the contact normal, free along the tangent
    STOP = 1  # stands until its next decision
    END = 2  # its attempt ends


class Afterwards(IntEnum):
    """What becomes of an agent that arrived or ended."""

    VANISH = 0
    STAY = 1


class Charge(IntEnum):
    """Who is charged when an agent that arrived or ended, and stayed, is hit."""

    HITTER = 0
    BOTH = 1


@dataclass(frozen=True)
class Clock:
    """Time [s]."""

    dt: float  # between decisions
    substeps: int  # integration steps within one decision
    steps: int  # decisions until the horizon
    decision_budget: float | None = None  # [s] that a decision may take; scored, not enforced

    @property
    def horizon(self) -> float:
        """[s]"""
        return self.steps * self.dt


@dataclass(frozen=True)
class Rules:
    """What counts as arriving, and what contacts do."""

    goal_tolerance: float  # [m] between centre and goal
    contact: ContactRule
    on_arrival: Afterwards
    on_end: Afterwards
    charge: Charge


@dataclass(frozen=True, eq=False)
class World:
    """Everything that the simulator needs to start an episode."""

    bounds: tuple[float, float, float, float]  # xmin, ymin, xmax, ymax [m]
    solids: tuple[Solid, ...]  # what never moves within the episode; walls first
    bodies: tuple[Body, ...]  # dynamic obstacles, then static ones that are re-placed within it
    agents: Agents
    teams: tuple[str, ...]
    sees: BoolArray  # (teams, teams): sees[i, j] is False where team i ignores team j
    clock: Clock
    rules: Rules
    sensing: Sensing
    stale_solids: tuple[Solid, ...] | None = (
        None  # as they stood before they moved; None: they did not
    )
    measurement_area: tuple[float, float, float, float] | None = (
        None  # where density is measured [m]
    )
    meshes: tuple[Mesh, ...] = ()  # of the solids that were cut from meshes
    redraws: int = 0  # draws that were thrown away because they were not solvable

    @property
    def relocates(self) -> bool:
        """True where static geometry moves within the episode."""
        return any(body.solid.kind == Kind.STATIC for body in self.bodies)
