"""The cost of navigators: time for decisions and resets, and memory."""

from collections.abc import Collection, Iterable

from benchnav.leaderboard.record import ALL, ALL_INTERQUARTILE, Record
from benchnav.report.analysis.view import View

MEANINGS = {
    "latency_p50": "one decision for all agents of one world: median",
    "latency_p95": "95 % of these decisions are faster",
    "latency_p99": "99 % of these decisions are faster",
    "decision_time_p50": "one decision per agent, many worlds at once: median",
    "decision_time_p99": "99 % of these are faster",
    "planning_time": "reset before the first decision",
    "over_budget": "share of decisions over the budget of the scenario",
    "peak_memory": "most memory of the process, with the simulator",
}
"""Metric → its meaning, in the order of tables."""


def costs(
    records: Iterable[Record], view: View, metrics: Collection[str] = tuple(MEANINGS)
) -> dict[str, dict[str, Record]]:
    """Return metric → navigator → its record over all scenarios, or of the only one.

    Metrics without a value are left out.
    """
    found: dict[str, dict[str, Record]] = {name: {} for name in metrics}
    for r in records:
        if r.metric not in found or not view.holds(r) or not r.episodes:
            continue
        if r.scenario == ALL_INTERQUARTILE or r.value != r.value:
            continue
        if r.scenario == ALL or r.navigator not in found[r.metric]:
            found[r.metric][r.navigator] = r
    return {metric: each for metric, each in found.items() if each}
