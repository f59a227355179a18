"""The order of the navigators in a table."""

import math
from collections.abc import Mapping, Sequence

from benchnav.leaderboard.record import Record


def leading(records: Sequence[Record], metrics: Sequence[str]) -> str:
    """Return the first of ``metrics`` that ranks; the first of all if none does."""
    ranked = {r.metric for r in records if r.ranked}
    return next((name for name in metrics if name in ranked), metrics[0])


def by_merit(leaders: Mapping[str, Record]) -> list[str]:
    """Return navigators by their records of the leading metric, the best first."""
    return sorted(sorted(leaders), key=lambda name: _merit(leaders[name]))


def _merit(r: Record) -> tuple[float, float, float]:
    """Return a sort key: ranked before unranked before missing; then by value."""
    if r.rank_low is None or r.rank_high is None:
        ranks = (math.inf, math.inf if math.isnan(r.value) else 0.0)
    else:
        ranks = (float(r.rank_low), float(r.rank_high))
    value = 0.0 if math.isnan(r.value) else r.value
    return (*ranks, value if r.better == "lower" else -value)
