"""Value and 95 % interval of every column of a stratum, and of means over strata."""

from dataclasses import dataclass

import numpy as np
from scipy.stats import trim_mean

from benchnav.arrays import BoolArray, FloatArray
from benchnav.leaderboard.interval import (
    bca,
    cumulants,
    effective_size,
    mean,
    recover,
    resampled_means,
    wilson,
)


@dataclass(frozen=True, eq=False)
class Estimate:
    """(C,) each; NaN bounds where the episodes give no interval."""

    value: FloatArray
    low: FloatArray
    high: FloatArray

    def put(self, columns: BoolArray, low: FloatArray | float, high: FloatArray | float) -> None:
        """Set the interval of some columns."""
        self.low[columns] = low
        self.high[columns] = high


@dataclass(frozen=True, eq=False)
class Column:
    """What is known of the metric of each column (C,)."""

    rate: BoolArray
    least: FloatArray  # possible value, may be infinite
    most: FloatArray


@dataclass(frozen=True, eq=False)
class Sample:
    """The columns of one stratum: n worlds."""

    value: FloatArray  # (n, C)
    agents: FloatArray  # (n, C)
    weights: FloatArray  # (R, n) bootstrap


def estimate(sample: Sample, column: Column) -> Estimate:
    """Rates: Wilson's interval at the effective size. Others: the bootstrap over worlds.

    Where all values of a bounded metric agree the bootstrap has no width; Wilson's
    interval, scaled to the metric's range, holds there. Where the range is not bounded,
    or fewer than two worlds have a value, there is no interval.
    """
    value = mean(sample.value)
    count = (~np.isnan(sample.value)).sum(axis=0)
    found = Estimate(value, np.full_like(value, np.nan), np.full_like(value, np.nan))
    rate = column.rate & (count > 0)
    size = effective_size(sample.value[:, rate], sample.agents[:, rate])
    found.put(rate, *wilson(value[rate], size))
    flat = ~rate & (count > 1) & ~_varies(sample.value)
    bounded = flat & np.isfinite(column.least) & np.isfinite(column.most)
    least, width = column.least[bounded], (column.most - column.least)[bounded]
    low, high = wilson((value[bounded] - least) / width, count[bounded].astype(np.float64))
    found.put(bounded, least + low * width, least + high * width)
    usual = ~rate & (count > 1) & ~flat
    second, third = cumulants(sample.value[:, usual])
    n = count[usual].astype(np.float64)
    means = resampled_means(sample.value[:, usual], sample.weights)
    found.put(usual, *bca(means, value[usual], third / (6 * second**1.5), n, n - 1))
    return found


def _varies(values: FloatArray) -> BoolArray:
    """(C,) whether a column (n, C) holds two different values."""
    low = np.where(np.isnan(values), np.inf, values).min(axis=0, initial=np.inf)
    high = np.where(np.isnan(values), -np.inf, values).max(axis=0, initial=-np.inf)
    varies: BoolArray = low < high
    return varies


def mean_over(parts: list[Estimate], samples: list[Sample], column: Column) -> Estimate:
    """Mean over strata of C columns, each stratum counting alike; those without a value do not.

    Rates, and bounded metrics that do not vary in some stratum, recover their variance
    from the intervals of the strata; others take a bootstrap stratified by scenario.
    """
    value, low, high = (
        np.array([getattr(part, name) for part in parts]) for name in ("value", "low", "high")
    )
    found = Estimate(mean(value), np.full(value.shape[1], np.nan), np.full(value.shape[1], np.nan))
    varies = np.array([_varies(sample.value) for sample in samples])
    bounded = np.isfinite(column.least) & np.isfinite(column.most)
    for c in range(value.shape[1]):
        has = ~np.isnan(value[:, c])
        one = np.arange(value.shape[1]) == c
        if column.rate[c] or (bounded[c] and not varies[has, c].all()):
            limits = column.least[c], column.most[c]
            found.put(one, *recover(value[has, c], low[has, c], high[has, c], *limits))
        elif varies[has, c].any():
            chosen = [sample for sample, here in zip(samples, has, strict=True) if here]
            found.put(one, *_stratified(chosen, one, found.value[one]))
    return found


def _stratified(
    samples: list[Sample], one: BoolArray, value: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """(1,), (1,) bootstrap interval of the mean over strata of one column."""
    counts = np.array([(~np.isnan(s.value[:, one])).sum() for s in samples], dtype=np.float64)
    if counts.min() < 2:
        return np.array([np.nan]), np.array([np.nan])
    means = np.mean([resampled_means(s.value[:, one], s.weights) for s in samples], axis=0)
    moments = np.array([cumulants(s.value[:, one]) for s in samples])  # (strata, 2, 1)
    second = (moments[:, 0] / counts[:, None] ** 2).sum(axis=0)
    third = (moments[:, 1] / counts[:, None] ** 3).sum(axis=0)
    freedom = np.array([counts.sum() - len(samples)])
    return bca(means, value, third / (6 * second**1.5), counts.min(keepdims=True), freedom)


def interquartile_mean_over(samples: list[Sample]) -> Estimate:
    """Mean over the middle half of the strata: bootstrap stratified by scenario, C columns.

    NaN where a stratum has no value, and no interval where one has fewer than two.
    R. Agarwal et al., "Deep reinforcement learning at the edge of the statistical
    precipice", NeurIPS 2021, with scenarios in the place of their runs.
    """
    values = np.array([mean(sample.value) for sample in samples])
    counts = np.array([(~np.isnan(s.value)).sum(axis=0) for s in samples], dtype=np.float64)
    whole = ~np.isnan(values).any(axis=0)
    centre = np.where(whole, trim_mean(np.nan_to_num(values), 0.25, axis=0), np.nan)
    found = Estimate(centre, np.full_like(centre, np.nan), np.full_like(centre, np.nan))
    for c in np.flatnonzero(whole & (counts.min(axis=0) > 1)):
        one = np.arange(len(centre)) == c
        drawn = [resampled_means(s.value[:, one], s.weights) for s in samples]
        means = np.asarray(trim_mean(drawn, 0.25, axis=0))
        if _varies(means)[0]:
            freedom = np.array([counts[:, c].sum() - len(samples)])
            fewest = counts[:, c].min(keepdims=True)
            found.put(one, *bca(means, centre[one], np.zeros(1), fewest, freedom))
    return found
