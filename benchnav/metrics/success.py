"""Success: the outcome of every agent. All are rates over the agents, failures included.

`success` and `arrival` rank. `timeout`, `stuck` and `failed` only distinguish outcomes: an agent
that crashes does not count in them.
"""

import math

import numpy as np

from benchnav.arrays import BoolArray, FloatArray
from benchnav.episode.episode import Episode
from benchnav.metrics.metric import metric
from benchnav.metrics.quantities.episode_analysis import analyse, endings
from benchnav.metrics.quantities.trajectory import positions_at

STUCK_WINDOW = 10.0  # [s]


@metric(
    title="Arrived, with no collision before arriving",
    unit="",
    better="higher",
    low=0.0,
    high=1.0,
    rate=True,
)
def success(episode: Episode) -> FloatArray:
    """(A,) 1 for agents that arrive before any charged contact starts.

    A contact that starts exactly at the arrival does not count. An agent whose navigator
    fails in the episode does not succeed.
    """
    return analyse(episode).success.astype(np.float64)


@metric(
    title="Came within goal tolerance before the horizon",
    unit="",
    better="higher",
    low=0.0,
    high=1.0,
    rate=True,
)
def arrival(episode: Episode) -> FloatArray:
    """(A,) 1 for agents that touch their goal disc before the horizon, also after collisions."""
    return analyse(episode).arrived.astype(np.float64)


@metric(title="Still on its way at the horizon", unit="", better=None, low=0.0, high=1.0, rate=True)
def timeout(episode: Episode) -> FloatArray:
    """(A,) 1 for agents that are still on their way when the record ends at the horizon."""
    found = analyse(episode)
    return (found.active_at_end & ~found.failed).astype(np.float64)


@metric(
    title="Timed out within one radius of its last place for 10 s",
    unit="",
    better=None,
    low=0.0,
    high=1.0,
    rate=True,
)
def stuck(episode: Episode) -> FloatArray:
    """(A,) 1 for agents that time out and stay within one radius of their last place for 10 s.

    NaN for all agents if the horizon is shorter than 10 s.
    """
    found = analyse(episode)
    if episode.world.clock.horizon < STUCK_WINDOW:
        return np.full(len(found.arrival), math.nan)
    timed_out = found.active_at_end & ~found.failed
    if not timed_out.any():
        return np.zeros(len(found.arrival))
    t = found.trajectories
    start = max(0.0, float(t.end.max(initial=0.0)) - STUCK_WINDOW)
    states = np.arange(t.position.shape[1]) * t.dt
    away = np.hypot(*(t.position - t.position[:, -1:]).transpose(2, 0, 1))
    recent = np.where(states >= start, away, 0.0).max(axis=1)
    first = np.hypot(*(positions_at(t, np.array([start])) - t.position[:, -1:]).transpose(2, 0, 1))
    still: BoolArray = np.maximum(recent, first[:, 0]) < episode.world.agents.radius
    return (still & timed_out).astype(np.float64)


@metric(title="Its navigator failed", unit="", better=None, low=0.0, high=1.0, rate=True)
def failed(episode: Episode) -> FloatArray:
    """(A,) 1 for agents whose navigator fails in this episode."""
    return analyse(episode).failed.astype(np.float64)


def success_time(episode: Episode) -> FloatArray:
    """Return success times (A,) [s], inf for agents without success, for `success_by_horizon`."""
    found = endings(episode)
    return np.where(found.success, found.arrival, math.inf)


def success_by_horizon(times: FloatArray, horizons: FloatArray) -> FloatArray:
    """Return success against horizon, the cumulative incidence of success: shares (H,).

    ``times`` (N,) [s] are the success times of *all* agents that are compared, inf for
    agents without success: failures stay in the denominator, so the curve rises to
    the success rate and not to 1. No agent is censored before the horizon of the
    episodes, so no correction for censoring is needed up to the horizon.

    The horizons of the curve are ``horizons`` (H,) [s]. NaN without agents.
    """
    if len(times) == 0:
        return np.full(len(horizons), math.nan)
    ordered = np.sort(times)
    share: FloatArray = np.searchsorted(ordered, horizons, side="right") / len(times)
    return share
