"""Compute: wall-clock time, the only part of an episode that cannot be verified.

Timings cover only the navigator's calls. In a run, a call serves a batch of worlds and its
time is divided by their number, so decision times measure throughput: they describe, and
never rank. Latency is the time of a decision for all agents of a single world, measured in
a separate pass; it ranks. It is NaN if there was no such pass.
"""

import math
from collections.abc import Callable

import numpy as np

from benchnav.arrays import BoolArray, FloatArray
from benchnav.episode.episode import Episode
from benchnav.metrics.metric import Direction, Metric, metric
from benchnav.metrics.quantities.episode_analysis import analyse


def _percentiles(
    name: str, times: Callable[[Episode], FloatArray], title: str, meaning: str,
    better: Direction | None,
) -> tuple[Metric, Metric, Metric]:  # fmt: skip
    """Return the 50th, 95th and 99th percentile of ``times(episode)`` (N,) [s], ascending."""

    def one(percent: int) -> Metric:
        rank = "median" if percent == 50 else f"{percent}th percentile of the"

        def function(episode: Episode, members: BoolArray) -> float:
            return _quantile(times(episode), percent / 100)

        function.__name__ = function.__qualname__ = f"{name}_p{percent}"
        function.__doc__ = f"[s] {rank} {meaning}."
        declare = metric(
            title=f"{rank[0].upper()}{rank[1:]} {title}", unit="s", better=better, low=0.0,
            scope="group", verifiable=False,
        )  # fmt: skip
        return declare(function)

    return one(50), one(95), one(99)


def _decision_times(episode: Episode) -> FloatArray:
    """Return (N,) [s] the time of each decision per active agent of the navigator, ascending."""
    return analyse(episode).decision_per_agent


def _latencies(episode: Episode) -> FloatArray:
    """Return (N,) [s] the time of each decision for a single world, ascending."""
    taken = episode.timings.latency
    return np.zeros(0) if taken is None else np.sort(taken)


def _quantile(ordered: FloatArray, share: float) -> float:
    """Return the quantile of ascending values (N,), interpolated linearly; NaN without any."""
    if len(ordered) == 0:
        return math.nan
    at = share * (len(ordered) - 1)
    k = int(at)
    low = float(ordered[k])
    return low if at == k else (float(ordered[k + 1]) - low) * (at - k) + low


decision_time_p50, decision_time_p95, decision_time_p99 = _percentiles(
    "decision_time", _decision_times, "decision time per agent",
    "time per decision and agent", None,
)  # fmt: skip
latency_p50, latency_p95, latency_p99 = _percentiles(
    "latency", _latencies, "time for a decision of one world alone",
    "time of a decision for a single world", "lower",
)  # fmt: skip


@metric(
    title="Most memory that the process held",
    unit="B",
    better=None,
    low=0.0,
    scope="group",
    verifiable=False,
)
def peak_memory(episode: Episode, members: BoolArray) -> float:
    """[B] peak memory of the process until the episode's end; NaN if unknown.

    It includes the simulator, all imported modules, and the episodes that ran before.
    """
    memory = episode.timings.memory
    return math.nan if memory is None else float(memory)


@metric(
    title="Time before the first decision",
    unit="s",
    better="lower",
    low=0.0,
    scope="group",
    verifiable=False,
)
def planning_time(episode: Episode, members: BoolArray) -> float:
    """[s] time of the navigator's reset: the share of this world."""
    return float(episode.timings.planning)


@metric(
    title="Share of decisions over the scenario's budget",
    unit="",
    better="lower",
    low=0.0,
    high=1.0,
    scope="group",
    verifiable=False,
)
def over_budget(episode: Episode, members: BoolArray) -> float:
    """Share of decisions that took longer than the scenario's budget; NaN without one."""
    budget, decision = episode.world.clock.decision_budget, episode.timings.decision
    if budget is None or len(decision) == 0:
        return math.nan
    return float((decision > budget).mean())
