"""Paired differences of means over fixed scenarios: value, 95 % interval and p-value.

The interval and the p-value come from one Student statistic: the interval contains 0 exactly
if p ≥ 0.05. docs/statistics.md gives the reasons, false alarms, coverage and power.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Self

import numpy as np
from scipy.special import stdtr

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.leaderboard.statistics.estimate import Column
from benchnav.leaderboard.statistics.interval import students

EVENTS = 2.0  # unobserved events that are added to the variance of a bounded metric
UNSEEN = 0.5  # weight of the largest difference in the size of these events
ROUNDING = 1e-12  # of the largest difference: smaller deviations are rounding


@dataclass(frozen=True, eq=False)
class Moments:
    """The differences of one scenario: C columns, without worlds that have no difference."""

    count: IntArray  # (C,) worlds
    mean: FloatArray  # (C,) NaN without a world
    squares: FloatArray  # (C,) sum of squared deviations from the mean
    cubes: FloatArray  # (C,) sum of cubed deviations from the mean
    sizes: FloatArray  # (C,) sum of absolute deviations from the mean
    largest: FloatArray  # (C,) absolute difference

    @classmethod
    def of(cls, differences: FloatArray) -> Self:
        """Return the moments of differences (n, C), NaN for a world without a difference."""
        known = ~np.isnan(differences)
        count = known.sum(axis=0)
        value = np.where(known, differences, 0.0)
        with np.errstate(invalid="ignore", divide="ignore"):
            mean = value.sum(axis=0) / count
        apart = np.where(known, differences - mean, 0.0)
        largest = np.abs(value).max(axis=0, initial=0.0)
        apart[np.abs(apart) <= ROUNDING * largest] = 0.0
        squares, cubes = (apart**2).sum(axis=0), (apart**3).sum(axis=0)
        return cls(count, mean, squares, cubes, np.abs(apart).sum(axis=0), largest)


@dataclass(frozen=True, eq=False)
class Difference:
    """(C,) each; bounds are NaN and p = 1 if the worlds give no interval."""

    worlds: IntArray
    value: FloatArray
    low: FloatArray
    high: FloatArray
    p: FloatArray  # two-sided, of the hypothesis of no difference


@dataclass(frozen=True, eq=False)
class _Strata:
    """The moments of S scenarios as arrays (S, C), and their weights."""

    count: IntArray
    mean: FloatArray  # 0 without a world
    squares: FloatArray
    cubes: FloatArray
    sizes: FloatArray
    largest: FloatArray
    share: FloatArray  # (S, C) weight of a scenario in the mean: equal for all that have a world

    @classmethod
    def of(cls, parts: Sequence[Moments]) -> Self:
        count, mean, squares, cubes, sizes, largest = (
            np.array([getattr(part, field.name) for part in parts]) for field in fields(Moments)
        )
        held = count > 0
        share = held / np.maximum(held.sum(axis=0), 1)
        mean = np.where(held, mean, 0.0)
        return cls(count, mean, squares, cubes, sizes, largest, share)

    @property
    def value(self) -> FloatArray:
        """The mean (C,) over scenarios of the means over worlds."""
        total: FloatArray = (self.share * self.mean).sum(axis=0)
        return np.where(self.count.any(axis=0), total, np.nan)


def difference(parts: Sequence[Moments], column: Column) -> Difference:
    """Return the mean over the scenarios ``parts`` of the mean differences of their worlds.

    Scenarios are fixed and have equal weights: the variance is that of the worlds within them, so a
    scenario with another difference adds none. ``column`` gives the known properties
    of the values, not of their differences.
    """
    strata = _Strata.of(parts)
    value, width = strata.value, column.most - column.least
    variance, freedom = _variance(strata)
    with np.errstate(invalid="ignore", divide="ignore"):
        error = np.sqrt(variance + EVENTS * _event(strata, variance, width) ** 2)
        skewness = _third(strata) / error**3
        against = np.maximum(-np.sign(value) * skewness, 0.0)
        p = 2.0 * stdtr(freedom, -_narrowed(np.abs(value) / error, against))
        down, up = (
            error * _widened(students(freedom), np.maximum(side * skewness, 0.0))
            for side in (-1.0, 1.0)
        )
    unknown = ~(error > 0.0)
    down[unknown] = up[unknown] = np.where(np.isfinite(width), 2.0 * width, np.nan)[unknown]
    low, high = np.maximum(value - down, -width), np.minimum(value + up, width)
    return Difference(strata.count.sum(axis=0), value, low, high, np.where(unknown, 1.0, p))


def _widened(worth: FloatArray, skewness: FloatArray) -> FloatArray:
    """Return the quantile (C,) of a skewed estimate's Student statistic for ``worth`` ≥ 0.

    If the long tail of the differences lies on the side of 0, large ones may not have been
    observed. N. J. Johnson, "Modified t tests and confidence intervals for asymmetrical
    populations", JASA 73 (1978): the term of the Cornish-Fisher expansion that grows with t,
    only where it widens the interval (ours).
    """
    return worth * (1.0 + skewness * worth / 3.0)


def _narrowed(t: FloatArray, skewness: FloatArray) -> FloatArray:
    """Return the ``worth`` (C,) that `_widened` turns into t ≥ 0."""
    root: FloatArray = np.sqrt(1.0 + 4.0 * skewness * t / 3.0)
    return 2.0 * t / (1.0 + root)


def _third(strata: _Strata) -> FloatArray:
    """Return the third cumulant (C,) of the mean over scenarios, by Fisher's k-statistic."""
    n = strata.count
    each = strata.share**3 * strata.cubes / np.maximum(n * (n - 1) * (n - 2), 1)
    total: FloatArray = each.sum(axis=0)
    return total


def _variance(strata: _Strata) -> tuple[FloatArray, FloatArray]:
    """Return the variance (C,) of the mean over scenarios, and its degrees of freedom (C,).

    B. L. Welch, "The generalization of 'Student's' problem when several different population
    variances are involved", Biometrika 34 (1947): the degrees of freedom of his section 6,
    which few worlds bias less than those of Satterthwaite, and never more than there are.
    The spread within a scenario of one world is unknown: its distance from the mean over
    scenarios replaces it, as if such scenarios were a sample. NaN for one world in all.
    """
    n, scenarios = strata.count, (strata.count > 0).sum(axis=0)
    single = n == 1
    with np.errstate(invalid="ignore", divide="ignore"):
        spread = np.where(n > 1, strata.squares / (n - 1), 0.0)
        apart = (strata.mean - strata.value) ** 2 * scenarios / (scenarios - 1)
        each = strata.share**2 * np.where(single, apart, spread / np.maximum(n, 1))
        variance: FloatArray = each.sum(axis=0)
        most = np.maximum(n - 1, single).sum(axis=0) - (single.sum(axis=0) == scenarios)
        freedom = variance**2 / (each**2 / (np.where(single, 2, n) + 1)).sum(axis=0) - 2.0
    freedom = np.where(variance > 0.0, np.clip(freedom, 1.0, np.maximum(most, 1.0)), most)
    return np.where(most > 0, variance, np.nan), freedom


def _event(strata: _Strata, variance: FloatArray, width: FloatArray) -> FloatArray:
    """Return the contribution (C,) of one more event, such as a collision, to the mean.

    If few worlds differ, their variance is too small: events that did not occur
    in these worlds are missing. A. Agresti and Y. Min, "Simple improved confidence intervals
    for comparing matched proportions", Statistics in Medicine 24 (2005), therefore add a
    world in each direction. Here the variance has `EVENTS` more, of the size of the
    observed deviations, because a world of many agents seldom differs by its whole
    range ``width`` (ours); the range is used if no world differs. A metric without a
    range has no such events, unless it does not vary.
    """
    n = np.maximum(strata.count, 1)
    weight = strata.share / n  # of a world
    usual = (n * weight**2).sum(axis=0)
    squares = (weight**2 * strata.squares * n / np.maximum(n - 1, 1)).sum(axis=0)
    sizes = (weight * strata.sizes).sum(axis=0)
    bounded: BoolArray = np.isfinite(width)
    largest = strata.largest.max(axis=0)
    whole = usual * np.where((largest == 0.0) & bounded, width, largest)
    with np.errstate(invalid="ignore", divide="ignore"):
        observed = (squares + UNSEEN * whole**2) / (sizes + UNSEEN * whole)
    found: FloatArray = np.where(whole == 0.0, 0.0, observed)
    return np.where(bounded | (variance == 0.0), found, 0.0)


def least_p(worlds: int) -> float:
    """Return the p-value if all ``worlds`` of one scenario differ by a bounded metric's range."""
    return float(2.0 * stdtr(worlds - 1, -worlds / np.sqrt(EVENTS))) if worlds > 1 else 1.0
