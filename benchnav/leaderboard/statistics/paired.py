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
    """Every pair of navigators on one metric, in every scenario, track and role.

    The pairs in one scenario, track and role are a family. Also pairs of which one
    rehearsed: each says how many rehearsals both were granted, and is not judged.
    ``results`` has the schema `benchnav.store.parts.results.RESULTS`. Raises UsageError for a
    metric that is not among ``metrics``, or where one label stands for two navigators.
    """
    if metric not in metrics:
        raise UsageError(
            f"A metric to compare by must be a known one. Got {metric!r} instead."
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
    """Column c compares navigators ``first[c]`` and ``second[c]`` of ``s`` by ``metrics[c]``.

    Not judged yet.
    """
    apart = side_by_side(s, first, second, metrics)
    found = difference([Moments.of(apart)], columns_of(metrics))
    return [
        Comparison(
            s.navigators[i], s.navigators[j], s.scenario, s.track, s.role, metrics[c].name,
            int(found.worlds[c]), float(found.value[c]), float(found.low[c]),
            float(found.high[c]), float(found.p[c]), s.split, s.scenario_hash, s.horizon, s.dt,
            int(s.granted[i]), int(s.granted[j]),
        )
        for c, (i, j) in enumerate(zip(first, second, strict=True))
    ]  # fmt: skip


def side_by_side(
    s: Stratum, first: IntArray, second: IntArray, metrics: Sequence[Metric]
) -> FloatArray:
    """The differences (n, C) of `differences`; NaN where ``s`` has no such metric or value."""
    place = np.array([s.metrics.index(m.name) if m.name in s.metrics else -1 for m in metrics])
    apart = s.value[:, first, place] - s.value[:, second, place]
    return np.where(place >= 0, apart, np.nan)
