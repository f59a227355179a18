"""Who ranks where on each metric, and why somebody does not rank."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.leaderboard.compare import (
    comparable,
    flips_for,
    holm,
    pairs,
    ranks,
    sign_flip,
)
from benchnav.metrics.metric import Metric
from benchnav.plural import counted


@dataclass(frozen=True)
class Standing:
    """A rank interval among ``ranked`` entries, or the reason for none."""

    low: int | None
    high: int | None
    ranked: int
    note: str


@dataclass
class _Contest:
    """One metric: its entrants (N',) and the paired differences (n, C) among them."""

    metric: int
    entrants: IntArray
    differences: FloatArray
    notes: dict[int, str] = field(default_factory=dict)


def standings(
    value: FloatArray,
    attempted: BoolArray,
    stratum: IntArray,
    names: Sequence[str],
    metrics: Mapping[str, Metric],
) -> list[list[Standing]]:
    """[metric][navigator], from values (n, N, M) in the worlds attempted (n, N).

    ``stratum`` (n,) numbers the scenario of each world: scenarios count alike.
    """
    covered = comparable(attempted)
    contests = []
    for m, name in enumerate(names):
        metric = metrics.get(name)
        never = _never(metric)
        if metric is None or never:
            contests.append(_Contest(m, _NOBODY, _NO_DIFFERENCES, _everybody(attempted, never)))
        else:
            contests.append(_contest(m, value[:, :, m], attempted, covered, stratum, metric))
    return _judge(contests, attempted.shape[1])


_NOBODY = np.zeros(0, dtype=np.int64)
_NO_DIFFERENCES = np.zeros((0, 0))


def _never(metric: Metric | None) -> str:
    """Why nobody ranks on a metric; "" where they may."""
    if metric is None:
        return "the metric's definition is not installed"
    if metric.better is None:
        return "descriptive"
    return "conditional on arriving" if metric.conditional else ""


def _everybody(attempted: BoolArray, note: str) -> dict[int, str]:
    return dict.fromkeys(range(attempted.shape[1]), note)


def _contest(
    index: int,
    value: FloatArray,
    attempted: BoolArray,
    covered: BoolArray,
    stratum: IntArray,
    metric: Metric,
) -> _Contest:
    """Enter those that attempted the same worlds and have a value wherever any of them has."""
    known: BoolArray = ~np.isnan(value)
    owed: BoolArray = np.any(known[:, covered], axis=1)
    gaps = (owed[:, None] & ~known).sum(axis=0)
    entrants = np.flatnonzero(covered & (gaps == 0) & owed.any())
    worlds = int(attempted[:, covered].any(axis=1).sum())
    notes = {}
    for n in range(value.shape[1]):
        if not covered[n]:
            own = int(attempted[:, n].sum())
            notes[n] = (
                f"attempted {counted(own, 'world')} and not the same {worlds} as those that are"
            )
        elif not known[:, n].any():
            notes[n] = "undefined in every episode"
        elif gaps[n]:
            notes[n] = f"undefined in {counted(gaps[n], 'episode')} in which others have a value"
        elif len(entrants) < 2:
            notes[n] = "nobody to rank with"
    if len(entrants) < 2:
        return _Contest(index, _NOBODY, _NO_DIFFERENCES, notes)
    first, second = pairs(len(entrants))
    sign = 1.0 if metric.better == "higher" else -1.0
    entered = sign * value[:, entrants] * weights_of(owed, stratum)[:, None]
    entered[~owed] = 0.0
    return _Contest(index, entrants, entered[:, first] - entered[:, second], notes)


def weights_of(owed: BoolArray, stratum: IntArray) -> FloatArray:
    """(n,) what each world counts for in the mean over strata of means over worlds."""
    size = np.bincount(stratum[owed], minlength=int(stratum.max()) + 1)
    return 1.0 / (np.maximum(size, 1)[stratum] * np.count_nonzero(size))


def _judge(contests: list[_Contest], navigators: int) -> list[list[Standing]]:
    """All metrics in one pass of sign flips; Holm within each metric."""
    held = [contest for contest in contests if len(contest.entrants)]
    p = np.zeros(0)
    if held:
        most = max(contest.differences.shape[1] for contest in held)
        p = sign_flip(np.hstack([c.differences for c in held]), flips_for(most))
    table, at = [], 0
    for contest in contests:
        count = len(contest.entrants)
        row = [Standing(None, None, 0, contest.notes.get(n, "")) for n in range(navigators)]
        if count:
            size = contest.differences.shape[1]
            lead = contest.differences.sum(axis=0)
            low, high = ranks(lead, holm(p[at : at + size]), count)
            at += size
            for place, n in enumerate(contest.entrants):
                row[n] = Standing(int(low[place]), int(high[place]), count, "")
        table.append(row)
    return table
