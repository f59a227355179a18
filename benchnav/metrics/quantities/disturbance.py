"""The effect of evaluated agents on people: their ways beside those in the undisturbed world.

A record ends when the evaluated agents are done, which many people are not. Each person is
compared at the end of the record: one on its way counts as arriving later by its remaining way,
the shortest among walls, at its preferred speed. The same holds for the undisturbed person at the
same time, so what both lack cancels.
"""

from typing import NamedTuple

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.episode.episode import Episode
from benchnav.metrics.quantities.episode_analysis import Analysis, analyse
from benchnav.metrics.quantities.trajectory import INSTANT


class Disturbance(NamedTuple):
    """The changes for N people."""

    delay: FloatArray  # (N,) [s] later arrival
    detour: FloatArray  # (N,) [m] longer way


class _Progress(NamedTuple):
    """N people at the end of a window."""

    arrived: BoolArray  # (N,)
    time: FloatArray  # (N,) [s] of their arrival, or the end of the window
    way: FloatArray  # (N,) [m] travelled
    place: FloatArray  # (N, 2) [m]


def disturbance(episode: Episode, undisturbed: Episode) -> Disturbance:
    """Return what differs for the people who react, by agent.

    ``undisturbed`` is the episode in the same world without the evaluated agents. It may end
    first, when all agents of the first background navigator arrived: a person of another one, who
    is still on its way then, is compared at that time.
    """
    people, agents = episode.world.people[0], episode.world.agents
    found, other = analyse(episode), analyse(undisturbed)
    steps, shorter = len(episode.requested), len(undisturbed.requested)
    there = np.isnan(other.arrival) & (shorter < steps)
    window = np.where(there, shorter, steps)
    after = _progress(found, people, window)
    before = _progress(other, np.arange(len(people)), window)
    left = _remaining(found, people, before, after)
    (time, way), (usual_time, usual_way) = (
        (p.time + left[k] / agents.preferred_speed[people], p.way + left[k])
        for k, p in ((1, after), (0, before))
    )
    return Disturbance(time - usual_time, way - usual_way)


def _progress(found: Analysis, agents: IntArray, window: IntArray) -> _Progress:
    """Return where ``agents`` (N,) are after ``window`` (N,) decisions, or after their last."""
    t, rows = found.trajectories, np.arange(len(agents))
    place = t.position[agents]
    window = np.minimum(window, place.shape[1] - 1)
    step = np.diff(place, axis=1)
    way = np.cumsum(np.hypot(step[..., 0], step[..., 1]), axis=1)
    way = np.concatenate([np.zeros((len(agents), 1)), way], axis=1)
    end, arrival = window * t.dt, found.arrival[agents]
    arrived = arrival <= end + INSTANT
    time = np.where(arrived, arrival, end)
    return _Progress(arrived, time, way[rows, window], place[rows, window])


def _remaining(
    found: Analysis, people: IntArray, before: _Progress, after: _Progress
) -> tuple[FloatArray, FloatArray]:
    """Return the remaining ways (N,) [m] before and after; straight if one has no shortest way."""
    world, goal = found.world, found.world.agents.goal[people]
    both = [found.ways_to_goal(people, progress.place) for progress in (before, after)]
    known = np.isfinite(both[0]) & np.isfinite(both[1])
    ways = []
    for progress, way in zip((before, after), both, strict=True):
        offset = goal - progress.place
        away = np.hypot(offset[:, 0], offset[:, 1]) - world.rules.goal_tolerance
        left = np.where(known, way, np.maximum(away, 0.0))
        ways.append(np.where(progress.arrived, 0.0, left))
    return ways[0], ways[1]
