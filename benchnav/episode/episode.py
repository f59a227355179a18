"""The immutable record of one run of one navigator in one world."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from benchnav.arena.world import World
from benchnav.arrays import BoolArray, ByteArray, FloatArray, IntArray


class Status(IntEnum):
    """The state of an agent at one time."""

    ACTIVE = 0
    ARRIVED = 1  # it touched its goal disc
    ENDED = 2  # its attempt ended (contact rule END)
    FAILED = 3  # its navigator failed: it does not move, and its episode counts as a failure
    WAITING = 4  # it has not entered the arena yet: it has no body


@dataclass(frozen=True)
class Identity:
    """The identity of an episode."""

    scenario: str  # "leaders/dynamic@1"
    scenario_hash: str
    split: str  # train, validation, test
    seed: int
    track: str  # known, stale, partial, unknown
    navigator: str  # the label in the suite
    navigator_hash: str = ""  # of the navigator: configuration, distributions, mode
    rehearsal: int = 0  # k: the k-th rehearsal before the episode of this seed; 0: that episode
    source_hash: str = ""  # of the code and data files of the navigator; "" if unknown
    perception: str = "exact"  # exact, noisy


@dataclass(frozen=True, eq=False)
class Contacts:
    """Collision events, one row each: a maximal interval of contact of one agent with one partner.

    Sorted by (agent, start). An event between two agents has a row for each of them.
    """

    agent: IntArray  # (N,)
    kind: ByteArray  # (N,) of Kind: AGENT, WALL, STATIC, DYNAMIC
    partner: IntArray  # (N,) agent index, or index into solids (WALL, STATIC), or -1 - body index
    start: FloatArray  # (N,) [s]
    end: FloatArray  # (N,) [s]
    penetration: FloatArray  # (N,) largest depth of overlap [m]
    closing_speed: FloatArray  # (N,) at first touch [m/s]
    charged: BoolArray  # (N,) False if the rules do not charge this agent

    def __len__(self) -> int:
        return len(self.agent)


@dataclass(frozen=True, eq=False)
class Timings:
    """Wall-clock seconds; the only part of an episode that cannot be verified."""

    decision: FloatArray  # (T,) of the batched call, divided by its number of worlds
    planning: float  # within reset, this world's share
    batch: int  # worlds that shared the calls
    latency: FloatArray | None = None  # (K,) of calls for only this world; None: not measured
    memory: int | None = None  # [bytes] peak RAM of its process; None: unknown
    rehearsal: float = 0.0  # of the leading navigator, in all rehearsals of this world


@dataclass(frozen=True, eq=False)
class Episode:
    """States at decision times 0..T and commands in between, for all A agents.

    T is the number of decisions taken: an episode stops early when no evaluated
    agent is active any more.
    """

    identity: Identity
    world: World
    position: FloatArray  # (T+1, A, 2) [m]
    heading: FloatArray  # (T+1, A) [rad], in [-pi, pi)
    status: ByteArray  # (T+1, A) of Status
    requested: FloatArray  # (T, A, 2) commands of the navigator, of its own kind
    executed: FloatArray  # (T, A, 2) within limits; twists for unicycles and for requested twists
    body_position: FloatArray  # (T+1, M, 2) [m]
    arrival: FloatArray  # (A,) first arrival [s], NaN without an arrival
    contacts: Contacts
    timings: Timings
    failure: str = ""  # the reason why the navigator failed in this world; "" if it did not
    reproducible: bool = True  # False if a wall-clock budget had an influence
    digest: str = ""  # of states, commands and events
    rehearsals: int = 0  # number granted to its navigator
    rehearsal_decisions: int = 0  # decisions of agents in all rehearsals
    remarks: tuple[str, ...] = ()  # remarks of its navigator on the episode
    traceback: str = ""  # of the navigator's exception; "" without one
    twist: BoolArray | None = None  # (A,) True: requested are twists; None: unknown (older)
    # returns the episode in the same world without the evaluated agents; None: there is none
    undisturbed: "Callable[[], Episode | None] | None" = None

    @property
    def times(self) -> FloatArray:
        """(T+1,) [s] times of the states."""
        return np.arange(len(self.position), dtype=np.float64) * np.float64(self.world.clock.dt)
