"""Estimates: value and 95 % interval of the columns of a stratum, and of means over strata."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from benchnav.arrays import BoolArray, CountArray, FloatArray, IntArray
from benchnav.leaderboard.statistics.interval import (
    bca,
    cumulants,
    effective_size,
    mean,
    mid_p,
    recover,
    resampled_means,
    trimmed_mean,
    unanimous,
)
from benchnav.metrics.metric import Metric

BLOCK = 64  # columns resampled at once


@dataclass(frozen=True, eq=False)
class Estimate:
    """(C,) each; the bounds are NaN if the episodes give no interval."""

    value: FloatArray
    low: FloatArray
    high: FloatArray

    def put(self, columns: BoolArray | IntArray, low: FloatArray, high: FloatArray) -> None:
        """Set the interval of some columns."""
        self.low[columns] = low
        self.high[columns] = high


@dataclass(frozen=True, eq=False)
class Column:
    """The known properties of the metric of each column (C,)."""

    rate: BoolArray
    least: FloatArray  # possible value, may be infinite
    most: FloatArray


def columns_of(metrics: Sequence[Metric | None]) -> Column:
    """Return the known properties of one column per metric; None: the metric is not installed."""
    return Column(
        np.array([m is not None and m.rate for m in metrics], dtype=np.bool_),
        np.array([-np.inf if m is None else m.low for m in metrics]),
        np.array([np.inf if m is None else m.high for m in metrics]),
    )


@dataclass(frozen=True, eq=False)
class Sample:
    """The columns of one stratum: n worlds."""

    value: FloatArray  # (n, C)
    agents: FloatArray  # (n, C)
    counts: CountArray  # (R, n) units in bootstrap resamples


def estimate(sample: Sample, column: Column) -> Estimate:
    """Estimate rates by the mid-P interval at the effective size, others by the bootstrap.

    If all values of a bounded metric are equal, the bootstrap has no width; the interval then
    shows how far unseen worlds could move the mean. If the range is not bounded, or
    fewer than two worlds have a value, there is no interval.
    """
    value = mean(sample.value)
    count = (~np.isnan(sample.value)).sum(axis=0)
    found = _unknown(value)
    rate = column.rate & (count > 0)
    size = effective_size(sample.value[:, rate], sample.agents[:, rate])
    found.put(rate, *mid_p(value[rate], size))
    flat = ~rate & (count > 1) & ~_varies(sample.value)
    bounded = flat & np.isfinite(column.least) & np.isfinite(column.most)
    limits = column.least[bounded], column.most[bounded]
    found.put(bounded, *unanimous(value[bounded], count[bounded], *limits))
    usual = ~rate & (count > 1) & ~flat
    second, third = cumulants(sample.value[:, usual])
    n = count[usual].astype(np.float64)
    means = resampled_means(sample.value[:, usual], sample.counts)
    found.put(usual, *bca(means, value[usual], third / (6 * second**1.5), n, n - 1))
    return found


def _varies(values: FloatArray) -> BoolArray:
    """Whether a column (n, C) holds two different values, (C,)."""
    low = np.where(np.isnan(values), np.inf, values).min(axis=0, initial=np.inf)
    high = np.where(np.isnan(values), -np.inf, values).max(axis=0, initial=-np.inf)
    varies: BoolArray = low < high
    return varies


def mean_over(parts: list[Estimate], samples: list[Sample], column: Column) -> Estimate:
    """Return the mean over strata of C columns, with equal weights of the strata with a value.

    Rates, and bounded metrics that do not vary in some stratum, recover their variance
    from the intervals of the strata; others use a bootstrap stratified by scenario.
    """
    value, low, high = (
        np.array([getattr(part, name) for part in parts]) for name in ("value", "low", "high")
    )
    found = _unknown(mean(value))
    has = ~np.isnan(value)
    varies = np.array([_varies(sample.value) for sample in samples])
    bounded = np.isfinite(column.least) & np.isfinite(column.most)
    recovered = column.rate | (bounded & (has & ~varies).any(axis=0))
    for c in np.flatnonzero(recovered & has.any(axis=0)):
        here, limits = has[:, c], (column.least[c], column.most[c])
        found.low[c], found.high[c] = recover(value[here, c], low[here, c], high[here, c], *limits)
    counts = _counts(samples)
    usual = ~recovered & varies.any(axis=0) & (np.where(has, counts, np.inf).min(axis=0) > 1)
    for strata, columns in _alike(has, usual):
        chosen = [samples[s] for s in strata]
        means = np.mean([resampled_means(s.value[:, columns], s.counts) for s in chosen], axis=0)
        n = counts[strata][:, columns]
        moments = np.array([cumulants(s.value[:, columns]) for s in chosen])  # (strata, 2, C)
        second, third = (moments[:, 0] / n**2).sum(axis=0), (moments[:, 1] / n**3).sum(axis=0)
        freedom = n.sum(axis=0) - len(strata)
        interval = bca(
            means, found.value[columns], third / (6 * second**1.5), n.min(axis=0), freedom
        )
        found.put(columns, *interval)
    return found


def interquartile_mean_over(samples: list[Sample]) -> Estimate:
    """Return the interquartile mean over strata: bootstrap stratified by scenario, C columns.

    NaN if a stratum has no value, and no interval if a stratum has fewer than two.
    R. Agarwal et al., "Deep reinforcement learning at the edge of the statistical
    precipice", NeurIPS 2021, with scenarios in the place of their runs.
    """
    values = np.array([mean(sample.value) for sample in samples])
    whole = ~np.isnan(values).any(axis=0)
    found = _unknown(np.where(whole, trimmed_mean(np.nan_to_num(values), 0.25), np.nan))
    counts = _counts(samples)
    for _, columns in _alike(np.ones_like(values, dtype=np.bool_), counts.min(axis=0) > 1):
        drawn = [resampled_means(s.value[:, columns], s.counts) for s in samples]
        means = trimmed_mean(np.array(drawn), 0.25)
        n = counts[:, columns]
        straight = np.zeros(len(columns))
        freedom = n.sum(axis=0) - len(samples)
        low, high = bca(means, found.value[columns], straight, n.min(axis=0), freedom)
        varies = _varies(means)
        found.put(columns[varies], low[varies], high[varies])
    return found


def _unknown(value: FloatArray) -> Estimate:
    return Estimate(value, np.full_like(value, np.nan), np.full_like(value, np.nan))


def _counts(samples: list[Sample]) -> FloatArray:
    """Return the number of values (strata, C) of each stratum."""
    return np.array([(~np.isnan(s.value)).sum(axis=0) for s in samples], dtype=np.float64)


def _alike(has: BoolArray, wanted: BoolArray) -> Iterator[tuple[IntArray, IntArray]]:
    """Yield groups of columns that have values in the same strata, with these strata."""
    patterns, pattern = np.unique(has[:, wanted], axis=1, return_inverse=True)
    columns = np.flatnonzero(wanted)
    for p in range(patterns.shape[1]):
        same = columns[pattern.ravel() == p]
        for start in range(0, len(same), BLOCK):
            yield np.flatnonzero(patterns[:, p]), same[start : start + BLOCK]
