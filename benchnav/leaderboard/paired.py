"""Paired differences between navigators in the worlds of a stratum."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from benchnav.arrays import IntArray
from benchnav.errors import UsageError, did_you_mean
from benchnav.leaderboard.compare import flips_for, pairs, sign_flip
from benchnav.leaderboard.comparison import Comparison, as_family
from benchnav.leaderboard.difference import Pairs, difference
from benchnav.leaderboard.estimate import columns_of
from benchnav.leaderboard.grid import Stratum, strata
from benchnav.leaderboard.interval import resample
from benchnav.leaderboard.label import require_one_navigator_per_label
from benchnav.metrics.metric import Metric

if TYPE_CHECKING:
    import pyarrow as pa


def comparisons(
    results: pa.Table, metrics: Mapping[str, Metric], metric: str
) -> tuple[Comparison, ...]:
    """Every pair of navigators on one metric, in every scenario, track and role.

    The pairs in one scenario, track and role are a family. Also pairs of which one
    rehearsed: each says how many rehearsals both were granted, and is not judged.
    ``results`` has the schema `benchnav.store.results.RESULTS`. Raises UsageError for a
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
            every = differences(s, first, second, [metrics[metric]] * len(first), len(first))
            found += as_family(every, metrics)
    return tuple(found)


def differences(
    s: Stratum, first: IntArray, second: IntArray, metrics: Sequence[Metric], family: int
) -> list[Comparison]:
    """Column c compares navigators ``first[c]`` and ``second[c]`` of ``s`` by ``metrics[c]``.

    Not judged yet; ``family`` says with how many others they will be.
    """
    sides = side_by_side(s, first, second, metrics)
    mean = difference(sides, columns_of(metrics))
    apart = sides.differences.value
    p = sign_flip(apart, flips_for(family))
    worlds = (~np.isnan(apart)).sum(axis=0)
    return [
        Comparison(
            s.navigators[i], s.navigators[j], s.scenario, s.track, s.role, metrics[c].name,
            int(worlds[c]), float(mean.value[c]), float(mean.low[c]), float(mean.high[c]),
            float(p[c]), s.split, s.scenario_hash, s.horizon, s.dt,
            int(s.granted[i]), int(s.granted[j]),
        )
        for c, (i, j) in enumerate(zip(first, second, strict=True))
    ]  # fmt: skip


def side_by_side(s: Stratum, first: IntArray, second: IntArray, metrics: Sequence[Metric]) -> Pairs:
    """The columns (n, C) that `differences` compares; NaN where ``s`` lacks a metric."""
    place = np.array([s.metrics.index(m.name) if m.name in s.metrics else -1 for m in metrics])
    held = place >= 0
    one, other = (np.where(held, s.value[:, side, place], np.nan) for side in (first, second))
    weights = resample(len(s.seeds), s.rng("difference"))
    agents = s.agents[:, first, place], s.agents[:, second, place]
    return Pairs(one, other, *agents, weights)
