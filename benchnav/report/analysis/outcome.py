"""The outcome of an agent's attempt: success, or the first event that made success impossible."""

from enum import IntEnum

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import ByteArray, FloatArray, IntArray
from benchnav.episode.episode import Episode
from benchnav.metrics.quantities.episode_analysis import endings
from benchnav.metrics.success import stuck


class Outcome(IntEnum):
    """The outcomes, from the best to the worst in the order of figures."""

    SUCCESS = 0
    TIMEOUT = 1
    STUCK = 2
    HIT_AGENT = 3
    HIT_DYNAMIC = 4
    HIT_STATIC = 5
    HIT_WALL = 6
    NAVIGATOR_FAILED = 7
    OTHER = 8

    @property
    def text(self) -> str:
        """The outcome in words."""
        return _TEXTS[self]


_TEXTS = {
    Outcome.SUCCESS: "success",
    Outcome.TIMEOUT: "timeout, moving",
    Outcome.STUCK: "timeout, stuck",
    Outcome.HIT_AGENT: "collision: agent",
    Outcome.HIT_DYNAMIC: "collision: moving obstacle",
    Outcome.HIT_STATIC: "collision: static obstacle",
    Outcome.HIT_WALL: "collision: wall",
    Outcome.NAVIGATOR_FAILED: "navigator failed",
    Outcome.OTHER: "ended by a contact without a charge",
}
HITS = {
    Kind.AGENT: Outcome.HIT_AGENT, Kind.DYNAMIC: Outcome.HIT_DYNAMIC,
    Kind.STATIC: Outcome.HIT_STATIC, Kind.WALL: Outcome.HIT_WALL,
}  # fmt: skip
NO_CONTACT = -1


def outcomes(episode: Episode) -> tuple[ByteArray, IntArray]:
    """Return the `Outcome` of every agent (A,), and the row of the contact (A,) that caused it.

    A collision is the first charged contact before an arrival: it excludes success, also for an
    agent that goes on and times out. Its row is an index into ``episode.contacts``; for other
    outcomes it is `NO_CONTACT`. The share of agents with `Outcome.SUCCESS` is the metric `success`.
    """
    found, contacts = endings(episode), episode.contacts
    arrival = np.where(found.arrived, found.arrival, np.inf)
    outcome = np.full(len(arrival), int(Outcome.OTHER), np.int8)
    cause = np.full(len(arrival), NO_CONTACT, np.int64)
    if found.active_at_end.any():
        still = stuck(episode) == 1.0
        outcome[found.active_at_end] = int(Outcome.TIMEOUT)
        outcome[found.active_at_end & still] = int(Outcome.STUCK)
    outcome[found.arrived] = int(Outcome.SUCCESS)
    early = np.flatnonzero(contacts.charged & (contacts.start < arrival[contacts.agent]))
    agents, first = np.unique(contacts.agent[early], return_index=True)  # rows are in time order
    cause[agents] = early[first]
    outcome[agents] = [int(HITS[Kind(kind)]) for kind in contacts.kind[early[first]].tolist()]
    outcome[found.failed] = int(Outcome.NAVIGATOR_FAILED)
    cause[found.failed] = NO_CONTACT
    return outcome, cause


def place_of(episode: Episode, agent: int, time: float) -> FloatArray:
    """Return the place (2,) [m] of an agent at a time [s], by the straight line between states."""
    at = time / episode.world.clock.dt
    last = len(episode.position) - 1
    before = min(int(at), last)
    share = min(at - before, 1.0)
    first, second = episode.position[before, agent], episode.position[min(before + 1, last), agent]
    place: FloatArray = (1.0 - share) * first + share * second
    return place
