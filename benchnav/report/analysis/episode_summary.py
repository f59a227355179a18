"""The outcomes, success times and collisions of one episode, without its trajectories."""

from dataclasses import dataclass

import numpy as np

from benchnav.arena.agents import Role
from benchnav.episode.episode import Episode
from benchnav.leaderboard.statistics.curve import Attempt, attempts_of
from benchnav.report.analysis.outcome import NO_CONTACT, Outcome, outcomes, place_of
from benchnav.report.analysis.partner import partner_name


@dataclass(frozen=True)
class Collision:
    """The first charged contact of an agent that did not arrive before it."""

    agent: int
    role: str
    partner: str  # the name of the obstacle, wall or team
    time: float  # [s]
    place: tuple[float, float]  # of the agent [m]


@dataclass(frozen=True, eq=False)
class EpisodeSummary:
    """An episode without its trajectories."""

    navigator: str
    scenario: str
    split: str
    variant: str  # `variant_name` of its worlds
    tracks: tuple[str, ...]  # an episode without a map stands for several
    perception: str
    seed: int
    attempts: tuple[Attempt, ...]  # by role, in the track of the stored episode
    shares: tuple[tuple[str, tuple[float, ...]], ...]  # role → share of agents per `Outcome`
    collisions: tuple[Collision, ...]


def summarise(episode: Episode, tracks: tuple[str, ...]) -> EpisodeSummary:
    """Return the summary of an episode that stands for ``tracks``."""
    identity, agents = episode.identity, episode.world.agents
    outcome, cause = outcomes(episode)
    shares = []
    for role in Role:
        members = agents.evaluated & (agents.role == role)
        if members.any():
            count = np.bincount(outcome[members], minlength=len(Outcome))
            shares.append((role.name.lower(), tuple((count / members.sum()).tolist())))
    hit = np.flatnonzero(agents.evaluated & (cause != NO_CONTACT)).tolist()
    clock = episode.world.clock
    return EpisodeSummary(
        navigator=identity.navigator,
        scenario=identity.scenario,
        split=identity.split,
        variant=variant_name(identity.scenario_hash, clock.horizon, clock.dt),
        tracks=tracks,
        perception=identity.perception,
        seed=identity.seed,
        attempts=tuple(attempts_of(episode)),
        shares=tuple(shares),
        collisions=tuple(_collision(episode, agent, int(cause[agent])) for agent in hit),
    )


def variant_name(digest: str, horizon: float, dt: float) -> str:
    """Return what distinguishes results of a scenario that must not be mixed. Times are in s."""
    return f"horizon {horizon:g} s, time step {dt:g} s, hash {digest}"


def _collision(episode: Episode, agent: int, row: int) -> Collision:
    world, contacts = episode.world, episode.contacts
    time = float(contacts.start[row])
    x, y = place_of(episode, agent, time).tolist()
    return Collision(
        agent=agent,
        role=Role(world.agents.role[agent]).name.lower(),
        partner=partner_name(world, int(contacts.kind[row]), int(contacts.partner[row])),
        time=time,
        place=(x, y),
    )
