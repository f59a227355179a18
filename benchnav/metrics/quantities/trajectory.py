"""Every agent's trajectory, cut where its attempt is over: the ground that metrics stand on.

An agent moves from the start until it arrives, ends or fails; what the record holds
after that instant is not its doing and never counts. An agent that arrives within a
step stops there and then, so its last segment lasts until its arrival, not until the
end of the step.
"""

from dataclasses import dataclass

import numpy as np

from benchnav.arena.world import Afterwards
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.episode.episode import Episode, Status

INSTANT = 1e-9  # [s] a segment that is shorter than this has no velocity


@dataclass(frozen=True, eq=False)
class Trajectories:
    """The motion of all agents, agents first."""

    dt: float  # [s]
    last: IntArray  # (A,) index of the first state that is not active, T if all are
    end: FloatArray  # (A,) [s] when its attempt was over: arrival, or the time of ``last``
    position: FloatArray  # (A, T+1, 2) [m], constant from ``last`` on
    duration: FloatArray  # (A, T) [s] for which each segment was travelled, 0 from ``last`` on
    velocity: FloatArray  # (A, T, 2) [m/s] mean over each segment, 0 from ``last`` on
    leaves: IntArray  # (A,) index of the state from which the agent is no body any more; T+1: never
    length: FloatArray  # (A,) [m] travelled
    moved: BoolArray  # (A,) True where it travelled at least its own radius

    def __len__(self) -> int:
        return len(self.last)

    @property
    def speed(self) -> FloatArray:
        """(A, T) [m/s]"""
        return np.hypot(self.velocity[..., 0], self.velocity[..., 1])

    @property
    def counted(self) -> BoolArray:
        """(A, T) True for the segments before the agent's attempt was over."""
        steps: BoolArray = np.arange(self.duration.shape[1]) < self.last[:, None]
        return steps


def cut(episode: Episode) -> Trajectories:
    """The trajectories of all agents of an episode."""
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
    """(A,) [s]: the arrival where it lies in the segment before ``last``, else its time."""
    dt = episode.world.clock.dt
    before = np.maximum(last - 1, 0) * dt
    arrived = episode.status[-1] == int(Status.ARRIVED)
    within = arrived & (episode.arrival >= before - INSTANT)
    end: FloatArray = np.where(within, np.fmin(episode.arrival, last * dt), last * dt)
    return end


def _leaves(episode: Episode, last: IntArray) -> IntArray:
    """(A,) who vanishes does so once it has arrived or ended; who failed stands."""
    rules, final, states = episode.world.rules, episode.status[-1], len(episode.position)
    vanishes = (final == int(Status.ARRIVED)) & (rules.on_arrival == Afterwards.VANISH)
    vanishes |= (final == int(Status.ENDED)) & (rules.on_end == Afterwards.VANISH)
    return np.where(vanishes, last, states)


def positions_at(trajectories: Trajectories, times: FloatArray) -> FloatArray:
    """(A, N, 2) [m]: places at ``times`` (N,) [s], straight between states."""
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
    """(A, N) True where the agent is a body in the arena at ``times`` (N,) [s].

    Who vanishes is a body up to its arrival or end, that instant included.
    """
    gone = trajectories.leaves <= trajectories.duration.shape[1]
    here: BoolArray = ~gone[:, None] | (times[None] <= trajectories.end[:, None] + INSTANT)
    return here
