"""95 % intervals: Wilson's for rates, a corrected bootstrap for everything else.

Every function works on columns, so that one call serves all navigators and metrics.
docs/statistics.md holds the simulation by which the methods were chosen.
"""

import numpy as np
from scipy.special import ndtr, ndtri, stdtrit  # scipy.stats takes a second to import

from benchnav.arrays import FloatArray

ALPHA = 0.05
RESAMPLES = 2000


def wilson(rate: FloatArray, size: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Wilson score interval (C,), (C,) of rates (C,) from ``size`` (C,) independent trials.

    E. B. Wilson, "Probable inference, the law of succession, and statistical
    inference", JASA 22 (1927). It holds, and is only wider than needed, for the mean of
    any quantity in [0, 1], whose variance is at most rate·(1 − rate).
    """
    z = ndtri(1 - ALPHA / 2)
    centre = (rate + z * z / (2 * size)) / (1 + z * z / size)
    half = z / (1 + z * z / size) * np.sqrt(rate * (1 - rate) / size + z * z / (4 * size**2))
    low = np.where(rate == 0.0, 0.0, np.maximum(centre - half, 0.0))
    return low, np.where(rate == 1.0, 1.0, np.minimum(centre + half, 1.0))


def effective_size(rates: FloatArray, agents: FloatArray) -> FloatArray:
    """(C,) independent trials that (n, C) world rates of (n, C) agents are worth.

    agents / (1 + (m − 1)·ρ), with m agents a world (L. Kish, "Survey sampling", 1965)
    and ρ the one-way analysis-of-variance estimate of the correlation of agents that
    share a world, held within [0, 1] so that sharing a world never narrows an interval.
    Where all agents agree ρ cannot be estimated and is taken as 1: the worlds count.
    Few worlds estimate ρ badly, so the size shrinks by the squared ratio of Student's
    quantiles at agents − 1 and worlds − 1, but never below the worlds (E. L. Korn and
    B. I. Graubard, "Confidence intervals for proportions with small expected number of
    positive counts estimated from survey data", Survey Methodology 24, 1998; the floor
    is ours). NaN rates are left out.
    """
    known = ~np.isnan(rates)
    size = np.where(known, agents, 0.0)
    value = np.where(known, rates, 0.0)
    worlds = known.sum(axis=0)
    total = size.sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = (size * value).sum(axis=0) / total
        per_world = (total - (size**2).sum(axis=0) / total) / (worlds - 1)  # m, corrected
        between = (size * (value - mean) ** 2).sum(axis=0) / (worlds - 1)
        within = (size * value * (1 - value)).sum(axis=0) / (total - worlds)
        rho = (between - within) / (between + (per_world - 1) * within)
    rho = np.clip(np.where(np.isfinite(rho), rho, 1.0), 0.0, 1.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        worth = total / (1 + (total / worlds - 1) * rho)
        shrink = students(total - 1) / students(worlds - 1)
    effective: FloatArray = np.fmax(worth * shrink**2, worlds)
    return effective


def students(freedom: FloatArray) -> FloatArray:
    """(C,) Student's quantile at 1 − α/2; NaN without a degree of freedom."""
    return np.asarray(stdtrit(freedom, 1 - ALPHA / 2), dtype=np.float64)


def trimmed_mean(values: FloatArray, share: float) -> FloatArray:
    """Mean along the first axis without the ``share`` of it at either end."""
    cut = int(share * len(values))
    middle: FloatArray = np.sort(values, axis=0)[cut : len(values) - cut].mean(axis=0)
    return middle


def resample(count: int, rng: np.random.Generator) -> FloatArray:
    """(R, n) weights of bootstrap resamples of ``count`` units; each row sums to 1."""
    drawn = rng.integers(count, size=(RESAMPLES, count))
    drawn += count * np.arange(RESAMPLES)[:, None]
    counts = np.bincount(drawn.ravel(), minlength=RESAMPLES * count)
    return counts.reshape(RESAMPLES, count) / float(count)


def resampled_means(values: FloatArray, weights: FloatArray) -> FloatArray:
    """(R, C) means of the columns of (n, C) under weights (R, n), NaN values left out.

    Units without a value are resampled as well, for a new draw of seeds would leave
    another number of them undefined. A resample that holds no value at all (rarer than
    e⁻ᵏ for k values) repeats the mean.
    """
    known = ~np.isnan(values)
    total = weights @ np.where(known, values, 0.0)
    if known.all():
        return total
    share = weights @ known.astype(np.float64)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(share > 0, total / share, mean(values))


def mean(values: FloatArray) -> FloatArray:
    """(C,) mean of the columns of (n, C), NaN values left out; NaN where nothing is left."""
    known = ~np.isnan(values)
    with np.errstate(invalid="ignore"):
        found: FloatArray = np.where(known, values, 0.0).sum(axis=0) / known.sum(axis=0)
    return found


def cumulants(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(C,) Σ(x − x̄)² and (C,) Σ(x − x̄)³ of the columns of (n, C), NaN values left out."""
    centred = np.nan_to_num(values - mean(values), nan=0.0)
    return (centred**2).sum(axis=0), (centred**3).sum(axis=0)


def bca(
    means: FloatArray,
    estimate: FloatArray,
    acceleration: FloatArray,
    count: FloatArray,
    freedom: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Bias-corrected, accelerated, expanded bootstrap interval (C,), (C,).

    ``means`` (R, C) are resampled estimates of ``estimate`` (C,), ``count`` (C,) the
    values that a stratum gives (the fewest of any), and ``freedom`` (C,) the values less
    the strata. The correction is that of B. Efron, "Better bootstrap confidence
    intervals", JASA 82 (1987). The expansion, by which the normal quantile becomes
    √(n/(n − 1)) times Student's, is that of T. C. Hesterberg, "What teachers should know
    about the bootstrap", The American Statistician 69 (2015); joining the two is ours.
    """
    resamples = len(means)
    below = (means < estimate).sum(axis=0) + 0.5 * (means == estimate).sum(axis=0)
    bias = ndtri(np.clip(below / resamples, 0.5 / resamples, 1 - 0.5 / resamples))
    reach = np.sqrt(count / (count - 1)) * students(freedom)
    ordered = np.sort(np.ascontiguousarray(means.T), axis=1)
    low = _quantile(ordered, ndtr(_correct(bias, bias - reach, acceleration)))
    high = _quantile(ordered, ndtr(_correct(bias, bias + reach, acceleration)))
    return np.minimum(low, estimate), np.maximum(high, estimate)


def _correct(bias: FloatArray, side: FloatArray, acceleration: FloatArray) -> FloatArray:
    """(C,) normal quantile after correction; beyond the pole of the formula, the extreme."""
    pole = 1 - acceleration * side
    return np.where(pole > 0, bias + side / np.where(pole > 0, pole, 1.0), np.sign(side) * np.inf)


def _quantile(ordered: FloatArray, level: FloatArray) -> FloatArray:
    """(C,) quantile of each sorted row (C, R) at its own level (C,), interpolated."""
    at = level * (ordered.shape[1] - 1)
    lower = np.floor(at).astype(np.int64)
    upper = np.ceil(at).astype(np.int64)
    row = np.arange(len(ordered))
    part = at - lower
    found: FloatArray = ordered[row, lower] * (1 - part) + ordered[row, upper] * part
    return found


def recover(
    value: FloatArray, low: FloatArray, high: FloatArray, least: float, most: float
) -> tuple[float, float]:
    """Interval of the mean of (S,) independent estimates, from their own intervals.

    G. Y. Zou, W. Huang and X. Zhang, "A note on confidence interval estimation for a
    linear function of binomial proportions", Computational Statistics & Data Analysis 53
    (2009). So strata in which every episode succeeded, or failed, keep the width that
    Wilson's interval gives them. Held within the metric's range ``least`` to ``most``.
    """
    mean = float(value.mean())
    down = float(np.sqrt(((value - low) ** 2).sum())) / len(value)
    up = float(np.sqrt(((high - value) ** 2).sum())) / len(value)
    return max(mean - down, least), min(mean + up, most)
