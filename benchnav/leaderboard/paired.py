"""Paired differences between navigators, with intervals and Holm-adjusted p-values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from benchnav.errors import UsageError, did_you_mean
from benchnav.leaderboard.compare import flips_for, holm, pairs, sign_flip
from benchnav.leaderboard.estimate import Column, Sample, estimate
from benchnav.leaderboard.grid import Stratum, strata
from benchnav.leaderboard.interval import resample
from benchnav.leaderboard.label import require_one_navigator_per_label
from benchnav.metrics.metric import Metric

if TYPE_CHECKING:
    import pyarrow as pa


@dataclass(frozen=True)
class Comparison:
    """How much the first navigator's values exceed the second's in the worlds of both."""

    first: str
    second: str
    scenario: str
    track: str
    role: str
    metric: str
    worlds: int  # that both attempted and in which both have a value
    difference: float  # mean of first − second, in the metric's unit; NaN without such worlds
    low: float  # of its 95 % interval; NaN where the worlds give none
    high: float
    p: float  # of no difference, by sign flips
    adjusted: float  # after Holm, over all pairs of navigators in this scenario, track and role
    split: str
    scenario_hash: str
    horizon: float  # [s]
    dt: float  # [s]
    first_rehearsal: int = 0  # rehearsals of each world that the first was granted
    second_rehearsal: int = 0


def comparisons(
    results: pa.Table, metrics: Mapping[str, Metric], metric: str
) -> tuple[Comparison, ...]:
    """Every pair of navigators on one metric, in every scenario, track and role.

    Also pairs of which one rehearsed: each says how many rehearsals both were granted.
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
            found += _compare(s, metric)
    return tuple(found)


def _compare(s: Stratum, metric: str) -> list[Comparison]:
    value = s.value[:, :, s.metrics.index(metric)]
    first, second = pairs(len(s.navigators))
    difference = value[:, first] - value[:, second]
    free = np.full(len(first), np.inf)
    column = Column(rate=np.zeros(len(first), dtype=np.bool_), least=-free, most=free)
    weights = resample(len(s.seeds), s.rng("difference"))
    mean = estimate(Sample(difference, np.ones_like(difference), weights), column)
    p = sign_flip(difference, flips_for(len(s.navigators)))
    adjusted = holm(p)
    worlds = (~np.isnan(difference)).sum(axis=0)
    return [
        Comparison(
            s.navigators[i], s.navigators[j], s.scenario, s.track, s.role, metric,
            int(worlds[c]), float(mean.value[c]), float(mean.low[c]), float(mean.high[c]),
            float(p[c]), float(adjusted[c]), s.split, s.scenario_hash, s.horizon, s.dt,
            int(s.granted[i]), int(s.granted[j]),
        )
        for c, (i, j) in enumerate(zip(first, second, strict=True))
    ]  # fmt: skip
