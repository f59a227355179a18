"""The immutable record of one run of one navigator in one world."""

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
    FAILED = 3  # its navigator failed: it stands, and its episode counts as a failure


@dataclass(frozen=True)
class Identity:
    """Which episode this is."""

    scenario: str  # "leaders/dynamic@1"
    scenario_hash: str
    split: str  # train, validation, test
    seed: int
    track: str  # known, stale, partial, unknown
    navigator: str  # the label in the suite
    navigator_hash: str = ""  # of what the label stands for: configuration, distributions, mode
    rehearsal: int = 0  # k: the k-th rehearsal before the episode of this seed; 0: that episode
    source_hash: str = ""  # of the code and data files of the navigator; "" where not known


@dataclass(frozen=True, eq=False)
class Contacts:
    """Collision events, one row each: a maximal interval of contact of one agent with one partner.

    Sorted by (agent, start). An event between two agents stands once for each of them.
    """

    agent: IntArray  # (N,)
    kind: ByteArray  # (N,) of Kind: AGENT, WALL, STATIC, DYNAMIC
    partner: IntArray  # (N,) agent index, or index into solids (WALL, STATIC), or -1 - body index
    start: FloatArray  # (N,) [s]
    end: FloatArray  # (N,) [s]
    penetration: FloatArray  # (N,) greatest depth of overlap [m]
    closing_speed: FloatArray  # (N,) at first touch [m/s]
    charged: BoolArray  # (N,) False where the rules do not charge this agent

    def __len__(self) -> int:
        return len(self.agent)


@dataclass(frozen=True, eq=False)
class Timings:
    """Wall-clock seconds; the only part of an episode that cannot be verified."""

    decision: FloatArray  # (T,) of the batched call, divided by the worlds that it served
    planning: float  # within reset, this world's share
    batch: int  # worlds that shared the calls
    latency: FloatArray | None = None  # (K,) of calls for this world alone, apart; None: not taken
    memory: int | None = None  # [bytes] most that its process ever held in RAM; None: not known
    rehearsal: float = 0.0  # of the navigator that led, in all rehearsals of this world


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
    requested: FloatArray  # (T, A, 2) what the navigator answered, in its own kind of command
    executed: FloatArray  # (T, A, 2) within limits; a twist for unicycles and where one was asked
    body_position: FloatArray  # (T+1, M, 2) [m]
    arrival: FloatArray  # (A,) first arrival [s], NaN where it never came
    contacts: Contacts
    timings: Timings
    failure: str = ""  # why the navigator failed in this world; "" if it did not
    reproducible: bool = True  # False where a wall-clock budget decided anything
    digest: str = ""  # of states, commands and events
    rehearsals: int = 0  # that its navigator was granted
    rehearsal_decisions: int = 0  # of agents, in all of them
    remarks: tuple[str, ...] = ()  # what its navigator has to tell of it
    traceback: str = ""  # of what the navigator raised, as text; "" where it raised nothing
    twist: BoolArray | None = None  # (A,) True: requested are twists; None: older, not known

    @property
    def times(self) -> FloatArray:
        """(T+1,) [s]"""
        return np.arange(len(self.position), dtype=np.float64) * np.float64(self.world.clock.dt)
