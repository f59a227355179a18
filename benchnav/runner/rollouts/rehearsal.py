"""Rehearsals: runs of only the leaders in the same world, before the scored episode.

A navigator that asks for rehearsals never simulates the world itself. The runner drives the
leaders with the navigator that the entry names and with the map of the track. It stores every
rehearsal as an episode, gives the trajectories to the navigator and adds the cost to its own.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from benchnav.arena.world import World
from benchnav.arrays import IntArray
from benchnav.episode.episode import Episode, Status
from benchnav.generation.rehearsal_world import rehearsal_world, rehearsing
from benchnav.metrics.safety import collided
from benchnav.navigation.plugin.configure import split
from benchnav.navigation.rehearsal import Rehearsal
from benchnav.plugins import NAVIGATORS
from benchnav.runner.rollouts.rollout import Assignment, Seeded, rollout
from benchnav.runner.rollouts.seeding import phases


@dataclass
class Rehearsed:
    """The rehearsals of one world."""

    episodes: list[Episode] = field(default_factory=list)
    grant: list[Rehearsal] = field(default_factory=list)  # the trajectories for the navigator
    failure: str = ""  # why the leaders' navigator failed; "" if it did not
    traceback: str = ""  # of the failure

    @property
    def seconds(self) -> float:
        """The duration [s] of all calls of the leaders' navigator."""
        timings = [episode.timings for episode in self.episodes]
        return float(sum(t.planning + t.decision.sum() for t in timings))

    @property
    def decisions(self) -> int:
        """The number of decisions of leaders in all rehearsals."""
        return sum(int(_deciding(episode).sum()) for episode in self.episodes)


@dataclass(frozen=True)
class Performance:
    """A scored episode and its rehearsals."""

    episode: Episode
    rehearsed: Rehearsed

    @property
    def unled(self) -> tuple[str, ...]:
        """Teams with a leader that succeeded in no rehearsal, sorted."""
        grant = self.rehearsed.grant
        if not grant or self.rehearsed.failure:
            return ()
        failed = ~np.any([rehearsal.succeeded for rehearsal in grant], axis=0)
        agents = self.episode.world.agents
        team = agents.team[agents.evaluated][grant[0].agent[failed]]
        return tuple(sorted({self.episode.world.teams[t] for t in team}))


def perform(
    assignment: Assignment, worlds: Sequence[Seeded], charge: str = ""
) -> Iterator[list[Performance]]:
    """Run rehearsals and episodes, and yield performances batch by batch, as `rollout` does.

    If the leaders' navigator fails in a rehearsal, the episode of that world fails with its reason.
    """
    made = {seed: Rehearsed(failure=charge) for seed, _ in worlds}
    for k in range(1, assignment.rehearsals + 1):
        _rehearse(assignment, [w for w in worlds if not made[w[0]].failure], k, made)
    for reason in sorted({done.failure for done in made.values()}):
        chosen = [seeded for seeded in worlds if made[seeded[0]].failure == reason]
        grants = {seed: tuple(made[seed].grant) for seed, _ in chosen}
        for batch in rollout(assignment, chosen, reason, grants):
            yield [_charged(assignment, e, made[e.identity.seed]) for e in batch]


def _rehearse(
    assignment: Assignment, worlds: Sequence[Seeded], k: int, made: dict[int, Rehearsed]
) -> None:
    """Run the k-th rehearsal of every world. The batching does not affect it."""
    leading = assignment.leader
    if leading is None:
        raise ValueError("A navigator that rehearses must name the navigator that leads.")
    about = (assignment.salt, assignment.scenario_hash, assignment.split)
    index: dict[int, IntArray] = {}
    stage: list[Seeded] = []
    for seed, world in worlds:
        other, index[seed] = rehearsal_world(world, phases(*about, seed, k))
        stage.append((seed, other))
    scored = dict(worlds)
    role = replace(assignment, navigator=leading, rehearsal=k, rehearsals=0, leader=None)
    for batch in rollout(role, stage):
        for episode in batch:
            seed = episode.identity.seed
            done = made[seed]
            done.episodes.append(episode)
            place = np.cumsum(scored[seed].agents.evaluated) - 1  # index in the briefing
            done.grant.append(granted(episode, place[index[seed]]))
            if episode.failure:
                name = split(NAVIGATORS, leading)[0]
                done.failure = f"in rehearsal {k}, {name!r} that led: {episode.failure}"
                done.traceback = episode.traceback


def stored_grant(world: World, episodes: Iterable[Episode]) -> tuple[Rehearsal, ...]:
    """Return what a navigator received before the scored episode in ``world``.

    ``episodes`` are the rehearsals, by number.
    """
    place = (np.cumsum(world.agents.evaluated) - 1)[rehearsing(world.agents)]
    return tuple(granted(episode, place) for episode in episodes)


def granted(episode: Episode, place: IntArray) -> Rehearsal:
    """Return the information about the rehearsal ``episode`` that a navigator receives.

    ``place`` (A,) is the index in the briefing of each agent of the rehearsal.
    """
    led = np.flatnonzero(episode.world.agents.evaluated)
    return Rehearsal(
        dt=episode.world.clock.dt,
        agent=place[led],
        position=episode.position[:, led].copy(),
        last=_deciding(episode)[:, led].sum(axis=0),
        arrival=episode.arrival[led].copy(),
        collided=collided(episode)[led] > 0.0,
    )


def _deciding(episode: Episode) -> np.ndarray:
    """Return whether each evaluated agent decided at each time (T, A)."""
    active = episode.status[:-1] == int(Status.ACTIVE)
    return np.asarray(active & episode.world.agents.evaluated)


def _charged(assignment: Assignment, episode: Episode, done: Rehearsed) -> Performance:
    reproducible = episode.reproducible and all(e.reproducible for e in done.episodes)
    charged = replace(
        episode,
        rehearsals=assignment.rehearsals,
        rehearsal_decisions=done.decisions,
        timings=replace(episode.timings, rehearsal=done.seconds),
        reproducible=reproducible,
        traceback=episode.traceback or done.traceback,
    )
    return Performance(charged, done)
