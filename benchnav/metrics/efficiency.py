"""Efficiency: path length and time relative to the shortest way among walls and obstacles."""

import math

import numpy as np

from benchnav.arrays import BoolArray, FloatArray
from benchnav.episode.episode import Episode
from benchnav.metrics.metric import metric
from benchnav.metrics.quantities.episode_analysis import analyse

_ANDERSON = "Anderson et al. 2018, On evaluation of embodied navigation agents"
_YOKOYAMA = "Yokoyama et al. 2021, Success weighted by completion time"


@metric(title="Time until first arrival", unit="s", better="lower", low=0.0, conditional=True)
def time_to_goal(episode: Episode) -> FloatArray:
    """(A,) [s] time from the entry to the first arrival; NaN for agents that never arrive."""
    return _time_to_goal(episode)


@metric(title="Way travelled", unit="m", better=None, low=0.0)
def path_length(episode: Episode) -> FloatArray:
    """(A,) [m] length of the path in the plane until the attempt ends; turning adds nothing."""
    return analyse(episode).trajectories.length.copy()


@metric(title="Shortest way among walls and static obstacles", unit="m", better=None, low=0.0)
def geodesic_length(episode: Episode) -> FloatArray:
    """(A,) [m] shortest way of the agent's disc among walls and static obstacles to its goal disc.

    NaN if static geometry moves within the episode.
    """
    return analyse(episode).geodesic.copy()


@metric(
    title="Shortest way over way travelled",
    unit="",
    better="higher",
    low=0.0,
    high=1.0,
    conditional=True,
)
def efficiency(episode: Episode) -> FloatArray:
    """(A,) shortest way over way travelled, of agents that arrive.

    Limited to 1: chords between states cut corners slightly, so the measured length of a best
    path may be below the shortest. NaN if the shortest way has length 0.
    """
    found = analyse(episode)
    return np.where(found.arrived, _share(found.geodesic, found.trajectories.length), math.nan)


@metric(
    title="Success weighted by path length",
    unit="",
    better="higher",
    low=0.0,
    high=1.0,
    reference=_ANDERSON,
)
def spl(episode: Episode) -> FloatArray:
    """(A,) success weighted by path length: success · ℓ* / max(ℓ, ℓ*)."""
    found = analyse(episode)
    return found.success * _share(found.geodesic, found.trajectories.length)


@metric(
    title="Success weighted by completion time",
    unit="",
    better="higher",
    low=0.0,
    high=1.0,
    reference=_YOKOYAMA,
)
def sct(episode: Episode) -> FloatArray:
    """(A,) success weighted by completion time: success · T* / max(T, T*).

    T* is the time of the shortest way at the preferred speed. (Yokoyama et al. use the fastest
    time of their dynamics; the preferred speed is this project's choice.)
    """
    found = analyse(episode)
    best = found.geodesic / episode.world.agents.preferred_speed
    time = np.where(found.success, _time_to_goal(episode), best)
    return found.success * _share(best, time)


@metric(
    title="Time until the last one arrived",
    unit="s",
    better="lower",
    low=0.0,
    scope="group",
    conditional=True,
)
def makespan(episode: Episode, members: BoolArray) -> float:
    """[s] arrival time of the last of the members (A,); NaN unless all arrive."""
    times = analyse(episode).arrival[members]
    return float(times.max()) if len(times) else math.nan


def _time_to_goal(episode: Episode) -> FloatArray:
    """Return times (A,) [s] from the entry, at 0 for all evaluated agents, to the arrival."""
    found = analyse(episode)
    return found.arrival - found.trajectories.begin


def _share(best: FloatArray, taken: FloatArray) -> FloatArray:
    """Return best / max(taken, best); NaN if best is undefined, or 0 (a start at the goal)."""
    positive = np.where(best > 0.0, best, math.nan)
    share: FloatArray = positive / np.maximum(taken, positive)
    return share
