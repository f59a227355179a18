"""Safety: collisions and near misses.

An attempt that a crash ends early has less time to hit, or to be near, anything else. So
counts and shares of time only describe an attempt, and do not rank.
"""

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arena.world import ContactRule
from benchnav.arrays import FloatArray, IntArray
from benchnav.episode.episode import Episode
from benchnav.kernels import kernel, kernel_without_allocation
from benchnav.metrics.metric import metric
from benchnav.metrics.quantities.encounters import TTC_CAP
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.metrics.quantities.numpy_sum import numpy_sum
from benchnav.metrics.quantities.people import PERSONAL

INTIMATE = 0.45  # [m] Hall 1966: upper limit of intimate distance
_HALL = "Hall 1966, The Hidden Dimension"


@metric(
    title="Charged with at least one collision",
    unit="",
    better="lower",
    low=0.0,
    high=1.0,
    rate=True,
)
def collided(episode: Episode) -> FloatArray:
    """(A,) 1 for agents that are charged with at least one collision event."""
    return np.asarray(analyse(episode).charged.any(axis=0), np.float64)


@metric(title="Collision events with walls", unit="", better=None, low=0.0)
def collisions_wall(episode: Episode) -> FloatArray:
    """(A,) number of charged events with walls."""
    return _of_kind(episode, Kind.WALL)


@metric(title="Collision events with static obstacles", unit="", better=None, low=0.0)
def collisions_static(episode: Episode) -> FloatArray:
    """(A,) number of charged events with static obstacles."""
    return _of_kind(episode, Kind.STATIC)


@metric(title="Collision events with dynamic obstacles", unit="", better=None, low=0.0)
def collisions_dynamic(episode: Episode) -> FloatArray:
    """(A,) number of charged events with dynamic obstacles."""
    return _of_kind(episode, Kind.DYNAMIC)


@metric(title="Collision events with other agents", unit="", better=None, low=0.0)
def collisions_agent(episode: Episode) -> FloatArray:
    """(A,) number of charged events with other agents."""
    return _of_kind(episode, Kind.AGENT)


@metric(title="Time in collision", unit="s", better="lower", low=0.0)
def contact_time(episode: Episode) -> FloatArray:
    """(A,) [s] time in charged contact with at least one partner; overlapping events count once.

    NaN for all agents if the rules end an attempt at its first contact, which then lasts no time.
    """
    c, agents = episode.contacts, len(episode.world.agents)
    if episode.world.rules.contact == ContactRule.END:
        return np.full(agents, np.nan)
    first = np.flatnonzero(c.charged)[np.argsort(c.start[c.charged], kind="stable")]
    total = np.zeros(agents)
    add_contact_time(c.agent[first], c.start[first], c.end[first], np.zeros(agents), total)
    return total


@kernel_without_allocation
def add_contact_time(
    agent: IntArray, start: FloatArray, end: FloatArray, reached: FloatArray, total: FloatArray
) -> None:
    """Add the times [s] of contacts (N,), in order of their starts, to the ``total`` (A,).

    ``reached`` (A,) [s] is the time until which contacts are counted.
    """
    for n in range(len(agent)):
        a = agent[n]
        total[a] += max(0.0, end[n] - max(start[n], reached[a]))
        reached[a] = max(reached[a], end[n])


@metric(title="Smallest gap to anything that can be hit", unit="m", better="higher")
def min_clearance(episode: Episode) -> FloatArray:
    """(A,) [m] smallest gap to walls, obstacles and other agents; NaN if there are none.

    Negative for an overlap. Exact for motion that is straight between states. In worlds with bodies
    that are not discs, it is the gap between the shapes, at four times of each step.
    """
    clearance = analyse(episode).encounters.clearance
    return np.where(np.isfinite(clearance), clearance, np.nan)


@metric(
    title="Smallest time to a collision at constant velocities, up to 5 s",
    unit="s",
    better="higher",
    low=0.0,
    high=TTC_CAP,
    reference="Hayward 1972, Near-miss determination",
)
def min_time_to_collision(episode: Episode) -> FloatArray:
    """(A,) [s] smallest time to a collision, over all instants, at the velocities of the instant.

    It covers walls, obstacles and agents. 0 for an agent that touches something, charged or
    not; at most 5 s, which is also the value of an agent without a collision course within 5 s.
    A body that is not a disc counts as the circle around it.
    """
    found, contacts = analyse(episode), episode.contacts
    time = found.encounters.time_to_collision.copy()
    during = contacts.start <= found.trajectories.end[contacts.agent]
    time[contacts.agent[during]] = 0.0
    return time


@metric(
    title="Share of time with another agent nearer than 0.45 m, rim to rim",
    unit="",
    better=None,
    low=0.0,
    high=1.0,
    reference=_HALL,
)
def personal_space_intimate(episode: Episode) -> FloatArray:
    """(A,) share of its attempt with less than 0.45 m to another agent, rim to rim.

    NaN for an agent whose attempt ended at its start.
    """
    return _share_within(episode, INTIMATE)


@metric(
    title="Share of time with another agent nearer than 1.2 m, rim to rim",
    unit="",
    better=None,
    low=0.0,
    high=1.0,
    reference=_HALL,
)
def personal_space_personal(episode: Episode) -> FloatArray:
    """(A,) share of its attempt with less than 1.2 m to another agent, rim to rim.

    NaN for an agent whose attempt ended at its start.
    """
    return _share_within(episode, PERSONAL)


def _of_kind(episode: Episode, kind: Kind) -> FloatArray:
    return np.array(analyse(episode).charged[kind])


def _share_within(episode: Episode, distance: float) -> FloatArray:
    """Return shares (A,) of time; the gap to the nearest agent is linear between states."""
    found = analyse(episode)
    t, share = found.trajectories, np.empty(len(found.arrival))
    write_share_within(found.encounters.gap, distance, t.duration, t.total_duration, share)
    return share


@kernel
def write_share_within(
    gap: FloatArray, distance: float, duration: FloatArray, total: FloatArray, share: FloatArray
) -> None:
    """Write the shares (A,) of time with a gap (A, T+1) [m] below ``distance``."""
    within = np.empty(duration.shape[1])
    for a in range(len(duration)):
        for k in range(duration.shape[1]):
            before, after = gap[a, k] - distance, gap[a, k + 1] - distance
            part = 1.0 if before < 0.0 and after < 0.0 else 0.0
            if (before < 0.0) != (after < 0.0):
                part = min(before, after) / -abs(after - before)
            within[k] = part * duration[a, k]
        share[a] = numpy_sum(within) / total[a] if total[a] > 0.0 else np.nan
