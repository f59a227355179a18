"""Trajectories of all agents, cut at the end of each attempt: the input of metrics.

An agent moves from its entry until it arrives, ends or fails; the record before and after does
not count. An agent that arrives within a step stops at that instant, so its last segment
lasts until its arrival, not until the end of the step.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from benchnav.arena.world import Afterwards
from benchnav.arrays import BoolArray, ByteArray, FloatArray, IntArray
from benchnav.episode.episode import Episode, Status
from benchnav.kernels import kernel, kernel_without_allocation
from benchnav.metrics.quantities.numpy_sum import numpy_sum

INSTANT = 1e-9  # [s] a shorter segment has no velocity


@dataclass(frozen=True, eq=False)
class Trajectories:
    """The motion of all agents, agents first."""

    dt: float  # [s]
    last: IntArray  # (A,) index of the first state after its attempt, T if there is none
    end: FloatArray  # (A,) [s] end of its attempt: arrival, or the time of ``last``
    position: FloatArray  # (A, T+1, 2) [m], constant from ``last`` on
    duration: FloatArray  # (A, T) [s] travel time of each segment, 0 outside of its attempt
    velocity: FloatArray  # (A, T, 2) [m/s] mean over each segment, 0 outside of its attempt
    leaves: IntArray  # (A,) index of the first state without a body of the agent; T+1: never
    length: FloatArray  # (A,) [m] travelled
    moved: BoolArray  # (A,) it travelled at least its own radius
    enters: IntArray | None = None  # (A,) first state with a body, T+1: never; None: 0 for all

    def __len__(self) -> int:
        return len(self.last)

    @cached_property
    def speed(self) -> FloatArray:
        """(A, T) [m/s] mean speed over each segment."""
        return np.hypot(self.velocity[..., 0], self.velocity[..., 1])

    @cached_property
    def total_duration(self) -> FloatArray:
        """(A,) [s] sum of the durations of the segments."""
        return np.asarray(self.duration.sum(axis=1))

    @property
    def counted(self) -> BoolArray:
        """(A, T) True for the segments of the agent's attempt."""
        segments = np.arange(self.duration.shape[1])
        steps: BoolArray = segments < self.last[:, None]
        return steps if self.enters is None else steps & (segments >= self.enters[:, None])

    @cached_property
    def has_body(self) -> BoolArray:
        """(A, T+1) True for the states in which the agent is a body in the arena."""
        states = np.arange(self.position.shape[1])
        here: BoolArray = states < self.leaves[:, None]
        return here if self.enters is None else here & (states >= self.enters[:, None])

    @property
    def begin(self) -> FloatArray:
        """(A,) [s] when its attempt begins; T·dt for an agent that never enters."""
        if self.enters is None:
            return np.zeros(len(self))
        return np.minimum(self.enters, self.duration.shape[1]) * self.dt


def cut(episode: Episode) -> Trajectories:
    """Return the trajectories of all agents of an episode."""
    world = episode.world
    position = np.array(episode.position.transpose(1, 0, 2), np.float64, order="C")
    status = np.array(episode.status.T, np.int8, order="C")
    agents, steps = len(position), position.shape[1] - 1
    last, end, length = np.empty(agents, np.int64), np.empty(agents), np.empty(agents)
    duration, velocity = np.empty((agents, steps)), np.empty((agents, steps, 2))
    enters = (status == int(Status.WAITING)).sum(axis=1)
    cut_paths(
        status, np.array(episode.arrival), world.clock.dt, enters, position, last, end, duration,
        velocity, length,
    )  # fmt: skip
    return Trajectories(
        world.clock.dt, last, end, position, duration, velocity, _leaves(episode, last), length,
        length >= world.agents.radius, enters if enters.any() else None,
    )  # fmt: skip


@kernel
def cut_paths(
    status: ByteArray, arrival: FloatArray, dt: float, enters: IntArray, position: FloatArray,
    last: IntArray, end: FloatArray, duration: FloatArray, velocity: FloatArray,
    length: FloatArray,
) -> None:  # fmt: skip
    """Cut places (A, T+1, 2) [m] at the end of each attempt, and write the other arrays.

    The arrays are those of `Trajectories`. Inputs are the status (A, T+1), the arrival (A,) [s]
    and the state (A,) in which an agent enters: the attempt ends at the arrival if that is in
    the segment before ``last``, else at the time of ``last``.
    """
    agents, steps = duration.shape
    way = np.empty(steps)
    for a in range(agents):
        until = min(enters[a], steps)
        while until < steps and status[a, until] == Status.ACTIVE:
            until += 1
        last[a], end[a] = until, until * dt
        arrived = status[a, steps] == Status.ARRIVED
        if arrived and arrival[a] >= max(until - 1, 0) * dt - INSTANT:
            end[a] = min(arrival[a], end[a])
        for k in range(until + 1, steps + 1):
            position[a, k, 0], position[a, k, 1] = position[a, until, 0], position[a, until, 1]
        for k in range(steps):
            dx = position[a, k + 1, 0] - position[a, k, 0]
            dy = position[a, k + 1, 1] - position[a, k, 1]
            time = min((k + 1) * dt, end[a]) - min(k * dt, end[a]) if k >= enters[a] else 0.0
            moves = time >= INSTANT
            duration[a, k] = time
            velocity[a, k, 0] = dx / time if moves else 0.0
            velocity[a, k, 1] = dy / time if moves else 0.0
            way[k] = math.hypot(dx, dy)
        length[a] = numpy_sum(way)


def _leaves(episode: Episode, last: IntArray) -> IntArray:
    """Return the first state (A,) without a body; agents vanish at their arrival or end."""
    rules, final, states = episode.world.rules, episode.status[-1], len(episode.position)
    vanishes = (final == int(Status.ARRIVED)) & (rules.on_arrival == Afterwards.VANISH)
    vanishes |= (final == int(Status.ENDED)) & (rules.on_end == Afterwards.VANISH)
    return np.where(vanishes, last, states)


def positions_at(trajectories: Trajectories, times: FloatArray) -> FloatArray:
    """Return the places (A, N, 2) [m] at ``times`` (N,) [s], linear between states."""
    t, places = trajectories, np.empty((len(trajectories), len(times), 2))
    interpolate(t.position, t.velocity, t.duration, t.dt, times, places)
    return places


@kernel_without_allocation
def interpolate(
    position: FloatArray, velocity: FloatArray, duration: FloatArray, dt: float,
    times: FloatArray, places: FloatArray,
) -> None:  # fmt: skip
    """Write the ``places`` (A, N, 2) [m] at ``times`` (N,) [s] from arrays of `Trajectories`."""
    steps = duration.shape[1]
    for n in range(len(times)):
        k = min(max(int(times[n] / dt + 1e-9), 0), max(steps - 1, 0))
        for a in range(len(position)):
            elapsed = min(times[n] - k * dt, duration[a, k]) if steps > 0 else 0.0
            for axis in range(2):
                place = position[a, k, axis]
                places[a, n, axis] = place + velocity[a, k, axis] * elapsed if steps > 0 else place


def present_at(trajectories: Trajectories, times: FloatArray) -> BoolArray:
    """Return the mask (A, N) of agents that are bodies in the arena at ``times`` (N,) [s].

    An agent that vanishes is a body up to and including its arrival or end.
    """
    gone = trajectories.leaves <= trajectories.duration.shape[1]
    here: BoolArray = ~gone[:, None] | (times[None] <= trajectories.end[:, None] + INSTANT)
    return here & entered_at(trajectories, times)


def entered_at(trajectories: Trajectories, times: FloatArray) -> BoolArray:
    """Return the mask (A, N) of agents that have a body by ``times`` (N,) [s]."""
    if trajectories.enters is None:
        return np.ones((len(trajectories), len(times)), np.bool_)
    entered: BoolArray = times[None] >= trajectories.enters[:, None] * trajectories.dt - INSTANT
    return entered
