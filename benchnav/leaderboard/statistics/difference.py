"""Paired differences of means over fixed scenarios: value, 95 % interval and p-value.

The interval and the p-value come from one Student statistic: 0 lies in the interval exactly
where p ≥ 0.05. docs/statistics.md says why, and keeps its false alarms, coverage and power.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Self

import numpy as np
from scipy.special import stdtr

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.leaderboard.statistics.estimate import Column
from benchnav.leaderboard.statistics.interval import students

EVENTS = 2.0  # events that the variance of a bounded metric counts and no world showed
UNSEEN = 0.5  # of an event as large as the largest difference, which their size begins with
ROUNDING = 1e-12  # of the largest difference: smaller deviations are rounding


@dataclass(frozen=True, eq=False)
class Moments:
    """The differences of one scenario: C columns, worlds without a difference left out."""

    count: IntArray  # (C,) worlds
    mean: FloatArray  # (C,) NaN without a world
    squares: FloatArray  # (C,) sum of squared deviations from the mean
    cubes: FloatArray  # (C,) sum of cubed deviations from the mean
    sizes: FloatArray  # (C,) sum of absolute deviations from the mean
    largest: FloatArray  # (C,) absolute difference

    @classmethod
    def of(cls, differences: FloatArray) -> Self:
        """From (n, C) differences, NaN where a world has none."""
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
    """(C,) each; NaN bounds where the worlds give no interval, and p = 1 there."""

    worlds: IntArray
    value: FloatArray
    low: FloatArray
    high: FloatArray
    p: FloatArray  # two-sided, of no difference


@dataclass(frozen=True, eq=False)
class _Strata:
    """The moments of S scenarios as arrays (S, C), and what each counts for."""

    count: IntArray
    mean: FloatArray  # 0 without a world
    squares: FloatArray
    cubes: FloatArray
    sizes: FloatArray
    largest: FloatArray
    share: FloatArray  # (S, C) of a scenario in the mean: all that have a world count alike

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
        """(C,) mean over scenarios of the means over worlds."""
        total: FloatArray = (self.share * self.mean).sum(axis=0)
        return np.where(self.count.any(axis=0), total, np.nan)


def difference(parts: Sequence[Moments], column: Column) -> Difference:
    """Mean over the scenarios ``parts`` of the mean differences of their worlds.

    Scenarios are fixed and count alike: the variance is that of the worlds within them, so a
    scenario in which the difference is another one adds none. ``column`` says what is known
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
    """(C,) where a Student statistic of a skewed estimate has the quantile ``worth`` ≥ 0.

    If the long tail of the differences lies on the side of 0, large ones may not have been
    seen. N. J. Johnson, "Modified t tests and confidence intervals for asymmetrical
    populations", JASA 73 (1978): the term of the Cornish-Fisher expansion that grows with t,
    only where it widens the interval (ours).
    """
    return worth * (1.0 + skewness * worth / 3.0)


def _narrowed(t: FloatArray, skewness: FloatArray) -> FloatArray:
    """(C,) the ``worth`` of which `_widened` makes t ≥ 0."""
    root: FloatArray = np.sqrt(1.0 + 4.0 * skewness * t / 3.0)
    return 2.0 * t / (1.0 + root)


def _third(strata: _Strata) -> FloatArray:
    """(C,) third cumulant of the mean over scenarios, without bias (Fisher's k-statistic)."""
    n = strata.count
    each = strata.share**3 * strata.cubes / np.maximum(n * (n - 1) * (n - 2), 1)
    total: FloatArray = each.sum(axis=0)
    return total


def _variance(strata: _Strata) -> tuple[FloatArray, FloatArray]:
    """(C,), (C,) variance of the mean over scenarios, and its degrees of freedom.

    B. L. Welch, "The generalization of 'Student's' problem when several different population
    variances are involved", Biometrika 34 (1947): the degrees of freedom of his section 6,
    which few worlds bias less than those of Satterthwaite, and never more than there are.
    The spread within a scenario of one world is unknown: its distance from the mean over
    scenarios stands for it, as if such scenarios were a sample. NaN for one world in all.
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
    """(C,) what one more event would add to the mean: an arrival or a collision, say.

    Where few worlds differ, their variance is too small: events that did not happen to fall
    into these worlds are missing. A. Agresti and Y. Min, "Simple improved confidence intervals
    for comparing matched proportions", Statistics in Medicine 24 (2005), therefore count a
    world more in each direction. Here the variance counts `EVENTS` more, of the size of the
    deviations that were seen, because a world of many agents seldom differs by its whole
    range ``width`` (ours); that size is taken where no world differs. A metric without a
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
        seen = (squares + UNSEEN * whole**2) / (sizes + UNSEEN * whole)
    found: FloatArray = np.where(whole == 0.0, 0.0, seen)
    return np.where(bounded | (variance == 0.0), found, 0.0)


def least_p(worlds: int) -> float:
    """The p-value where all ``worlds`` of one scenario differ by the range of a bounded metric."""
    return float(2.0 * stdtr(worlds - 1, -worlds / np.sqrt(EVENTS))) if worlds > 1 else 1.0
