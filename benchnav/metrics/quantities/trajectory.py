"""Trajectories of all agents, cut at the end of each attempt: the input of metrics.

An agent moves from the start until it arrives, ends or fails; the record after that instant
does not count. An agent that arrives within a step stops at that instant, so its last segment
lasts until its arrival, not until the end of the step.
"""

from dataclasses import dataclass

import numpy as np

from benchnav.arena.world import Afterwards
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.episode.episode import Episode, Status

INSTANT = 1e-9  # [s] a shorter segment has no velocity


@dataclass(frozen=True, eq=False)
class Trajectories:
    """The motion of all agents, agents first."""

    dt: float  # [s]
    last: IntArray  # (A,) index of the first state that is not active, T if all are
    end: FloatArray  # (A,) [s] end of its attempt: arrival, or the time of ``last``
    position: FloatArray  # (A, T+1, 2) [m], constant from ``last`` on
    duration: FloatArray  # (A, T) [s] travel time of each segment, 0 from ``last`` on
    velocity: FloatArray  # (A, T, 2) [m/s] mean over each segment, 0 from ``last`` on
    leaves: IntArray  # (A,) index of the first state without a body of the agent; T+1: never
    length: FloatArray  # (A,) [m] travelled
    moved: BoolArray  # (A,) it travelled at least its own radius

    def __len__(self) -> int:
        return len(self.last)

    @property
    def speed(self) -> FloatArray:
        """(A, T) [m/s] mean speed over each segment."""
        return np.hypot(self.velocity[..., 0], self.velocity[..., 1])

    @property
    def counted(self) -> BoolArray:
        """(A, T) True for the segments before the end of the agent's attempt."""
        steps: BoolArray = np.arange(self.duration.shape[1]) < self.last[:, None]
        return steps


def cut(episode: Episode) -> Trajectories:
    """Return the trajectories of all agents of an episode."""
    dt, states = episode.world.clock.dt, len(episode.position)
    over = episode.status != int(Status.ACTIVE)  # (T+1, A)
    last = np.where(over.any(axis=0), over.argmax(axis=0), states - 1).astype(np.int64)
    until = np.minimum(np.arange(states), last[:, None])  # (A, T+1)
    position = np.ascontiguousarray(
        np.take_along_axis(episode.position.transpose(1, 0, 2), until[..., None], axis=1)
    )
    end = _end(episode, last)
    duration = np.diff(np.minimum(np.arange(states) * dt, end[:, None]), axis=1)
    segment = np.diff(position, axis=1)
    slow = duration < INSTANT
    velocity = np.where(slow[..., None], 0.0, segment / np.where(slow, 1.0, duration)[..., None])
    length = np.hypot(segment[..., 0], segment[..., 1]).sum(axis=1)
    return Trajectories(
        dt, last, end, position, duration, velocity, _leaves(episode, last), length,
        length >= episode.world.agents.radius,
    )  # fmt: skip


def _end(episode: Episode, last: IntArray) -> FloatArray:
    """Return ends (A,) [s]: the arrival if it is in the segment before ``last``, else its time."""
    dt = episode.world.clock.dt
    before = np.maximum(last - 1, 0) * dt
    arrived = episode.status[-1] == int(Status.ARRIVED)
    within = arrived & (episode.arrival >= before - INSTANT)
    end: FloatArray = np.where(within, np.fmin(episode.arrival, last * dt), last * dt)
    return end


def _leaves(episode: Episode, last: IntArray) -> IntArray:
    """Return the first state (A,) without a body; agents vanish at their arrival or end."""
    rules, final, states = episode.world.rules, episode.status[-1], len(episode.position)
    vanishes = (final == int(Status.ARRIVED)) & (rules.on_arrival == Afterwards.VANISH)
    vanishes |= (final == int(Status.ENDED)) & (rules.on_end == Afterwards.VANISH)
    return np.where(vanishes, last, states)


def positions_at(trajectories: Trajectories, times: FloatArray) -> FloatArray:
    """Return the places (A, N, 2) [m] at ``times`` (N,) [s], linear between states."""
    dt, steps = trajectories.dt, trajectories.duration.shape[1]
    if steps == 0:
        return np.repeat(trajectories.position, len(times), axis=1)
    k = np.clip((times / dt + 1e-9).astype(np.int64), 0, steps - 1)
    elapsed = np.minimum(times[None] - k * dt, trajectories.duration[:, k])
    places: FloatArray = (
        trajectories.position[:, k] + trajectories.velocity[:, k] * elapsed[..., None]
    )
    return places


def present_at(trajectories: Trajectories, times: FloatArray) -> BoolArray:
    """Return the mask (A, N) of agents that are bodies in the arena at ``times`` (N,) [s].

    An agent that vanishes is a body up to and including its arrival or end.
    """
    gone = trajectories.leaves <= trajectories.duration.shape[1]
    here: BoolArray = ~gone[:, None] | (times[None] <= trajectories.end[:, None] + INSTANT)
    return here
