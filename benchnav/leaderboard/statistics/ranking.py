"""The rank of each entry on each metric, or the reason for none."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.leaderboard.statistics.difference import Moments, difference
from benchnav.leaderboard.statistics.estimate import columns_of
from benchnav.leaderboard.statistics.significance import comparable, holm, pairs, ranks
from benchnav.metrics.metric import Metric
from benchnav.text.plural import counted


@dataclass(frozen=True)
class Standing:
    """A rank interval among ``ranked`` entries, or the reason for none."""

    low: int | None
    high: int | None
    ranked: int
    note: str


def standings(
    value: FloatArray,
    attempted: BoolArray,
    stratum: IntArray,
    names: Sequence[str],
    metrics: Mapping[str, Metric],
) -> list[list[Standing]]:
    """Return ranks [metric][navigator], from values (n, N, M) in the worlds attempted (n, N).

    ``stratum`` (n,) numbers the scenario of each world: scenarios have equal weights.
    """
    covered = comparable(attempted)
    table = []
    for m, name in enumerate(names):
        metric = metrics.get(name)
        never = _never(metric)
        if metric is None or never:
            table.append([Standing(None, None, 0, never)] * attempted.shape[1])
        else:
            table.append(_ranked(value[:, :, m], attempted, covered, stratum, metric))
    return table


def _never(metric: Metric | None) -> str:
    """Return the reason why no entry ranks on a metric; "" if entries may."""
    if metric is None:
        return "the metric's definition is not installed"
    if metric.better is None:
        return "descriptive"
    return "conditional on arriving" if metric.conditional else ""


def _ranked(
    value: FloatArray,
    attempted: BoolArray,
    covered: BoolArray,
    stratum: IntArray,
    metric: Metric,
) -> list[Standing]:
    """Rank the entries that attempted the same worlds and have a value wherever any has one."""
    known: BoolArray = ~np.isnan(value)
    owed: BoolArray = np.any(known[:, covered], axis=1)
    gaps = (owed[:, None] & ~known).sum(axis=0)
    entrants = np.flatnonzero(covered & (gaps == 0) & owed.any())
    worlds = int(attempted[:, covered].any(axis=1).sum())
    row = []
    for n in range(value.shape[1]):
        if not covered[n]:
            own = int(attempted[:, n].sum())
            note = f"attempted {counted(own, 'world')} and not the same {worlds} as those that are"
        elif not known[:, n].any():
            note = "undefined in every episode"
        elif gaps[n]:
            note = f"undefined in {counted(gaps[n], 'episode')} in which others have a value"
        else:
            note = "no other entry to rank with" if len(entrants) < 2 else ""
        row.append(Standing(None, None, 0, note))
    if len(entrants) > 1:
        low, high = _places(value[:, entrants], stratum, metric)
        for place, n in enumerate(entrants.tolist()):
            row[n] = Standing(int(low[place]), int(high[place]), len(entrants), "")
    return row


def _places(value: FloatArray, stratum: IntArray, metric: Metric) -> tuple[IntArray, IntArray]:
    """Return rank intervals (E,), (E,) of E entries, from differences of their values (n, E)."""
    first, second = pairs(value.shape[1])
    apart = value[:, first] - value[:, second]
    parts = [Moments.of(apart[stratum == s]) for s in np.unique(stratum)]
    found = difference(parts, columns_of([metric] * len(first)))
    lead = found.value if metric.better == "higher" else -found.value
    return ranks(lead, holm(found.p), value.shape[1])
