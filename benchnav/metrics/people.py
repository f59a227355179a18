"""People: effects of evaluated agents on the people around them.

People are the agents that the evaluated navigator does not drive, and the recorded people of a
scenario's `recording`. An obstacle with another law of motion is no person. Without people, these
metrics are not applicable.

Intrusion and avoidance are the numbers of Cordes et al. 2024 of an evaluated agent among people:
PedPy computes them with ``r_soc`` = 0.8 m, ``l_min`` = 0.2 m and ``tau_0`` = 3 s. A part belongs
to a pair, so the intrusion of the agent by people is also what the agent adds to the intrusions
of people. Places are those of frames at 5 Hz, with velocities from the frame before to the frame
after. A body that is not a disc counts as the circle around it, except in `collisions_at_fault`.

An attempt that a crash ends early has less time to be near people, so these metrics describe an
attempt, and do not rank.
"""

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.episode.episode import Episode
from benchnav.metrics.metric import metric
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.metrics.quantities.fault import own_approach, with_people

FAULT = 0.05  # [m/s] nuPlan: a slower vehicle stands, and is not at fault
_CORDES = "Cordes et al. 2024, as PedPy computes it"


@metric(
    title="Mean intrusion number towards people",
    unit="",
    better=None,
    low=0.0,
    reference=_CORDES,
    people=True,
)
def intrusion(episode: Episode) -> FloatArray:
    """(A,) mean over the attempt of Σ ((r_soc − l_min) / (r − l_min))², r to each person.

    r is the distance between centres; people farther than 3 r_soc do not count. 1 is a person at
    0.8 m, 9 a person at 0.4 m. Below 0.26 m the part of a person stays 100.

    NaN for an agent whose attempt ended at its start.
    """
    return _mean(episode, "intrusion")


@metric(
    title="Mean avoidance number towards people",
    unit="",
    better=None,
    low=0.0,
    high=10.0,
    reference=_CORDES,
    people=True,
)
def avoidance(episode: Episode) -> FloatArray:
    """(A,) mean over the attempt of tau_0 / τ, τ the smallest time to a collision with a person.

    Times are those at the velocities of the instant; without a collision course, the number
    is 0. Times below 0.3 s count as 0.3 s, also while an agent pushes a person.

    NaN for an agent whose attempt ended at its start.
    """
    return _mean(episode, "avoidance")


@metric(
    title="Share of time in personal space of people, weighted by approach",
    unit="",
    better=None,
    low=0.0,
    high=1.0,
    reference="own definition; Hall 1966 for the distance",
    people=True,
)
def personal_space_approach(episode: Episode) -> FloatArray:
    """(A,) share of its attempt with less than 1.2 m to a person, rim to rim, times a weight.

    The weight is the agent's own speed towards that person over its preferred speed, from 0 to 1:
    an agent that stands, leaves or passes adds nothing, whatever the person does. Of several
    people, the one with the greatest weight counts.

    NaN for an agent whose attempt ended at its start.
    """
    return _mean(episode, "approach")


@metric(
    title="Collision events with people",
    unit="",
    better=None,
    low=0.0,
    people=True,
)
def collisions_people(episode: Episode) -> FloatArray:
    """(A,) number of charged events with people."""
    rows = np.flatnonzero(with_people(episode) & episode.contacts.charged)
    return _counted(episode, episode.contacts.agent[rows])


@metric(
    title="Collision events with people that the agent moved into",
    unit="",
    better=None,
    low=0.0,
    reference="own definition; Karnchanachari et al. 2024 (nuPlan) for the speed of a standing"
    " vehicle",
    people=True,
)
def collisions_at_fault(episode: Episode) -> FloatArray:
    """(A,) number of charged events with people that the agent moved towards at the first touch.

    It moved if its own speed along the normal of the touch, by its executed command, was above
    0.05 m/s. If both moved into each other, it is at fault; if a person walks into an agent that
    stands, leaves or passes, it is not.
    """
    rows = np.flatnonzero(with_people(episode) & episode.contacts.charged)
    moved = own_approach(episode, rows) > FAULT
    return _counted(episode, episode.contacts.agent[rows[moved]])


def _mean(episode: Episode, name: str) -> FloatArray:
    """Return the means (A,) of a result of `Approaches`; NaN without people."""
    world, found = episode.world, analyse(episode)
    mean = np.full(len(world.agents), np.nan)
    if world.has_people:
        some = found.trajectories.end[world.agents.evaluated] > 0.0
        agents, frames = np.flatnonzero(world.agents.evaluated)[some], found.approaches.frames
        mean[agents] = getattr(found.approaches, name)[some].sum(axis=1) / frames[some]
    return mean


def _counted(episode: Episode, agent: IntArray) -> FloatArray:
    """Return the number (A,) of times that each evaluated agent occurs; NaN without people."""
    agents = episode.world.agents
    count = np.bincount(agent, minlength=len(agents)).astype(np.float64)
    return np.where(agents.evaluated & episode.world.has_people, count, np.nan)
