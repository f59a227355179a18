"""Compute: wall-clock time, the one part of an episode that nobody can verify.

Timings are those of the navigator's calls alone. In a run a call serves a batch of worlds
and its time is divided by them, so decision times tell throughput, describe, and never
rank. Latency is what one world alone waits for, all its agents together, measured in a
pass of its own; it ranks. NaN where that pass was not made.
"""

import math

import numpy as np

from benchnav.arrays import BoolArray, FloatArray
from benchnav.episode.episode import Episode
from benchnav.metrics.metric import Metric
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.metrics.success import OWN


def decision_time(episode: Episode, share: float) -> float:
    """[s] quantile ``share`` over decisions of the time per active agent of the navigator."""
    return _quantile(analyse(episode).decision_per_agent, share)


def latency(episode: Episode, share: float) -> float:
    """[s] quantile ``share`` of the time that one world alone waits for a decision."""
    taken = episode.timings.latency
    return math.nan if taken is None else _quantile(np.sort(taken), share)


def _quantile(ordered: FloatArray, share: float) -> float:
    """Of ascending values (N,), straight between them; NaN without any."""
    if len(ordered) == 0:
        return math.nan
    return float(np.interp(share * (len(ordered) - 1), np.arange(len(ordered)), ordered))


def decision_time_p50(episode: Episode, members: BoolArray) -> float:
    """[s] median time per decision and agent."""
    return decision_time(episode, 0.50)


def decision_time_p95(episode: Episode, members: BoolArray) -> float:
    """[s] 95th percentile of the time per decision and agent."""
    return decision_time(episode, 0.95)


def decision_time_p99(episode: Episode, members: BoolArray) -> float:
    """[s] 99th percentile of the time per decision and agent."""
    return decision_time(episode, 0.99)


def latency_p50(episode: Episode, members: BoolArray) -> float:
    """[s] median time that one world alone waits for a decision."""
    return latency(episode, 0.50)


def latency_p95(episode: Episode, members: BoolArray) -> float:
    """[s] 95th percentile of the time that one world alone waits for a decision."""
    return latency(episode, 0.95)


def latency_p99(episode: Episode, members: BoolArray) -> float:
    """[s] 99th percentile of the time that one world alone waits for a decision."""
    return latency(episode, 0.99)


def peak_memory(episode: Episode, members: BoolArray) -> float:
    """[B] most that the process held in memory until the episode's end; NaN where unknown.

    Of the whole process: simulator, what was imported, and whoever ran in it before.
    """
    memory = episode.timings.memory
    return math.nan if memory is None else float(memory)


def planning_time(episode: Episode, members: BoolArray) -> float:
    """[s] that this world took of the navigator's reset."""
    return float(episode.timings.planning)


def over_budget(episode: Episode, members: BoolArray) -> float:
    """Share of decisions that took longer than the scenario's budget; NaN without one."""
    budget, decision = episode.world.clock.decision_budget, episode.timings.decision
    if budget is None or len(decision) == 0:
        return math.nan
    return float((decision > budget).mean())


DECISION_TIME_P50, DECISION_TIME_P95, DECISION_TIME_P99 = (
    Metric(
        f"decision_time_{name}", f"{title} decision time per agent", "s", None, 0.0, math.inf,
        OWN, function, scope="group", verifiable=False,
    )
    for name, title, function in [
        ("p50", "Median", decision_time_p50),
        ("p95", "95th percentile of the", decision_time_p95),
        ("p99", "99th percentile of the", decision_time_p99),
    ]
)  # fmt: skip
LATENCY_P50, LATENCY_P95, LATENCY_P99 = (
    Metric(
        f"latency_{name}", f"{title} time for a decision of one world alone", "s", "lower", 0.0,
        math.inf, OWN, function, scope="group", verifiable=False,
    )
    for name, title, function in [
        ("p50", "Median", latency_p50),
        ("p95", "95th percentile of the", latency_p95),
        ("p99", "99th percentile of the", latency_p99),
    ]
)  # fmt: skip
PEAK_MEMORY = Metric(
    "peak_memory", "Most memory that the process held", "B", None, 0.0, math.inf, OWN,
    peak_memory, scope="group", verifiable=False,
)  # fmt: skip
PLANNING_TIME = Metric(
    "planning_time", "Time before the first decision", "s", "lower", 0.0, math.inf, OWN,
    planning_time, scope="group", verifiable=False,
)  # fmt: skip
OVER_BUDGET = Metric(
    "over_budget", "Share of decisions over the scenario's budget", "", "lower", 0.0, 1.0, OWN,
    over_budget, scope="group", verifiable=False,
)  # fmt: skip
