"""Paired differences between navigators in the worlds of a stratum."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.errors import UsageError, did_you_mean
from benchnav.leaderboard.label import require_one_navigator_per_label
from benchnav.leaderboard.statistics.comparison import Comparison, as_family
from benchnav.leaderboard.statistics.difference import Moments, difference
from benchnav.leaderboard.statistics.estimate import columns_of
from benchnav.leaderboard.statistics.significance import pairs
from benchnav.leaderboard.statistics.strata import Stratum, strata
from benchnav.metrics.metric import Metric

if TYPE_CHECKING:
    import pyarrow as pa


def comparisons(
    results: pa.Table, metrics: Mapping[str, Metric], metric: str
) -> tuple[Comparison, ...]:
    """Compare every pair of navigators on one metric, in every scenario, condition and role.

    The pairs in one scenario, condition and role are a family. If one of a pair
    rehearsed, the comparison gives the rehearsals of both, and has no verdict.
    ``results`` has the schema `benchnav.store.parts.results.RESULTS`. Raises UsageError for a
    metric that is not among ``metrics``, or if one label is used for two navigators.
    """
    if metric not in metrics:
        raise UsageError(
            f"A metric to compare by must be a known metric. Got {metric!r} instead."
            f"{did_you_mean(metric, metrics)}"
        )
    require_one_navigator_per_label({"the results": results})
    found: list[Comparison] = []
    for s in strata(results, metrics, mixed=True):
        if metric in s.metrics:
            first, second = pairs(len(s.navigators))
            every = differences(s, first, second, [metrics[metric]] * len(first))
            found += as_family(every, metrics)
    return tuple(found)


def differences(
    s: Stratum, first: IntArray, second: IntArray, metrics: Sequence[Metric]
) -> list[Comparison]:
    """Compare in column c navigators ``first[c]`` and ``second[c]`` of ``s`` by ``metrics[c]``.

    The comparisons have no verdict yet.
    """
    apart = side_by_side(s, first, second, metrics)
    found = difference([Moments.of(apart)], columns_of(metrics))
    return [
        Comparison(
            first=s.navigators[i],
            second=s.navigators[j],
            scenario=s.scenario,
            track=s.track,
            perception=s.perception,
            role=s.role,
            metric=metrics[c].name,
            worlds=int(found.worlds[c]),
            difference=float(found.value[c]),
            low=float(found.low[c]),
            high=float(found.high[c]),
            p=float(found.p[c]),
            split=s.split,
            scenario_hash=s.scenario_hash,
            horizon=s.horizon,
            dt=s.dt,
            first_rehearsal=int(s.granted[i]),
            second_rehearsal=int(s.granted[j]),
        )
        for c, (i, j) in enumerate(zip(first, second, strict=True))
    ]


def side_by_side(
    s: Stratum, first: IntArray, second: IntArray, metrics: Sequence[Metric]
) -> FloatArray:
    """Return the differences (n, C); NaN where ``s`` has no such metric or value."""
    place = np.array([s.metrics.index(m.name) if m.name in s.metrics else -1 for m in metrics])
    apart = s.value[:, first, place] - s.value[:, second, place]
    return np.where(place >= 0, apart, np.nan)
