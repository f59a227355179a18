"""Paired differences of means: value and 95 % interval of every column."""

from dataclasses import dataclass

import numpy as np

from benchnav.arrays import BoolArray, FloatArray
from benchnav.leaderboard.estimate import Column, Estimate, Sample, estimate
from benchnav.leaderboard.interval import mean


@dataclass(frozen=True, eq=False)
class Pairs:
    """What two sides did in the same n worlds, C columns."""

    first: FloatArray  # (n, C) values
    second: FloatArray  # (n, C)
    first_agents: FloatArray  # (n, C) over which a value was taken
    second_agents: FloatArray  # (n, C)
    weights: FloatArray  # (R, n) bootstrap

    @property
    def differences(self) -> Sample:
        """First less second, NaN where either has no value."""
        value = self.first - self.second
        return Sample(value, np.ones_like(value), self.weights)


def spread(column: Column) -> Column:
    """What is known of differences of values that are as ``column`` says."""
    width = column.most - column.least
    return Column(column.rate, -width, width)


def difference(pairs: Pairs, column: Column) -> Estimate:
    """Mean of first − second over the worlds in which both have a value.

    Rates: from both sides' own intervals and the correlation of their world rates.
    Others: the bootstrap over worlds. ``column`` tells of the values, not their differences.
    """
    sample, rate = pairs.differences, column.rate
    value = mean(sample.value)
    found = Estimate(value, np.full_like(value, np.nan), np.full_like(value, np.nan))
    if rate.any():
        found.put(rate, *_of_rates(pairs, column, rate))
    if not rate.all():
        rest = Sample(sample.value[:, ~rate], sample.agents[:, ~rate], sample.weights)
        other = estimate(rest, part(spread(column), ~rate))
        found.put(~rate, other.low, other.high)
    return found


def part(column: Column, which: BoolArray) -> Column:
    """Some of the columns."""
    return Column(column.rate[which], column.least[which], column.most[which])


def _of_rates(pairs: Pairs, column: Column, which: BoolArray) -> tuple[FloatArray, FloatArray]:
    """(C,), (C,) intervals of differences of correlated rates.

    The square-and-add method of R. G. Newcombe, "Improved confidence intervals for the
    difference between binomial proportions based on paired data", Statistics in Medicine
    17 (1998), method 8, in the general form of G. Y. Zou, Psychological Methods 12 (2007),
    with intervals at the effective size for his and the correlation over worlds for φ.
    """
    both = ~np.isnan(pairs.first + pairs.second)[:, which]
    one, other = (np.where(both, v[:, which], np.nan) for v in (pairs.first, pairs.second))
    limits = part(column, which)
    a = estimate(Sample(one, pairs.first_agents[:, which], pairs.weights), limits)
    b = estimate(Sample(other, pairs.second_agents[:, which], pairs.weights), limits)
    r = correlation(one, other)
    apart = a.value - b.value
    low = apart - _joined(a.value - a.low, b.high - b.value, r)
    high = apart + _joined(a.high - a.value, b.value - b.low, r)
    return np.maximum(low, -1.0), np.minimum(high, 1.0)


def _joined(one: FloatArray, other: FloatArray, r: FloatArray) -> FloatArray:
    """(C,) how far a difference reaches of which the sides reach so far."""
    reach: FloatArray = np.sqrt(np.maximum(one**2 - 2 * r * one * other + other**2, 0.0))
    return reach


def correlation(one: FloatArray, other: FloatArray) -> FloatArray:
    """(C,) of the columns (n, C) over worlds; 0 where one does not vary."""
    with np.errstate(invalid="ignore", divide="ignore"):
        x, y = (np.nan_to_num(side - mean(side), nan=0.0) for side in (one, other))
        size = np.sqrt((x**2).sum(axis=0) * (y**2).sum(axis=0))
        found: FloatArray = np.where(size > 0, (x * y).sum(axis=0) / size, 0.0)
    return found
