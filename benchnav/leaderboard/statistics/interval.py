"""95 % intervals: mid-P for rates, a corrected bootstrap for all other metrics.

Every function works on columns, so that one call serves all navigators and metrics.
docs/statistics.md describes the simulation by which the methods were chosen.
"""

from collections.abc import Callable

import numpy as np
from scipy.special import betainc, ndtr, ndtri, stdtrit  # importing scipy.stats takes a second

from benchnav.arrays import CountArray, FloatArray, IntArray

ALPHA = 0.05
RESAMPLES = 2000
PRIOR = 0.2  # worlds that are added to the estimate of a correlation
HALVINGS = 50
_BLOCK = 1 << 24  # weights that are computed at once: 128 MB


def mid_p(rate: FloatArray, size: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the mid-P interval (C,), (C,) of rates (C,) from ``size`` (C,) independent trials.

    Its bounds p leave P(X > x) + P(X = x)/2 = α/2 at either side of x = rate·size, with the
    binomial X continued to sizes that are not integers. H. O. Lancaster,
    "Significance tests in discrete distributions", JASA 56 (1961); as an interval,
    G. Berry and P. Armitage, "Mid-P confidence intervals: a brief review", The
    Statistician 44 (1995).
    """
    x = rate * size
    low = _solve(lambda p: _above(p, x, size) - ALPHA / 2, x)
    high = _solve(lambda p: _above(p, x, size) - (1 - ALPHA / 2), x)
    return np.where(rate == 0.0, 0.0, low), np.where(rate == 1.0, 1.0, high)


def _above(p: FloatArray, x: FloatArray, size: FloatArray) -> FloatArray:
    """Return P(X > x) + P(X = x)/2 (C,) of a binomial X, by its incomplete beta function."""
    least, rest = np.finfo(float).tiny, np.maximum(size - x, np.finfo(float).tiny)
    at_least = np.where(x > 0.0, betainc(np.maximum(x, least), rest + 1.0, p), 1.0)
    more = np.where(x < size, betainc(x + 1.0, rest, p), 0.0)
    found: FloatArray = 0.5 * (at_least + more)
    return found


def _solve(rising: Callable[[FloatArray], FloatArray], like: FloatArray) -> FloatArray:
    """Return the zero (C,) of ``rising`` between 0 and 1, by bisection."""
    low, high = np.zeros_like(like), np.ones_like(like)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        beyond = rising(middle) > 0.0
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return 0.5 * (low + high)


def unanimous(
    value: FloatArray, count: FloatArray, least: FloatArray, most: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the interval (C,), (C,) of means of ``count`` (C,) equal values.

    If a share q of worlds had another value, none of them would be observed with probability
    (1 − q)ⁿ, which is α/2 at q = 1 − (α/2)^(1/n); such values lie from ``least`` to ``most``.
    """
    others = 1.0 - (ALPHA / 2) ** (1.0 / count)
    return value - others * (value - least), value + others * (most - value)


def effective_size(rates: FloatArray, agents: FloatArray) -> FloatArray:
    """Return the number (C,) of independent trials that world rates (n, C) are equivalent to.

    With ``agents`` (n, C): agents / (1 + (m − 1)·ρ), with m agents a world (L. Kish,
    "Survey sampling", 1965) and ρ the one-way analysis-of-variance estimate of the correlation
    of agents that share a world, limited to [0, 1] so that sharing never narrows an interval.
    Few failures estimate ρ badly: a fifth of a world is added to its estimate, in half of
    which all agents succeed and in half none (ours). If all agents agree, this gives ρ = 1:
    the worlds count.
    Few worlds estimate ρ badly too, so the size shrinks by the squared ratio of Student's
    quantiles at agents − 1 and worlds − 1, but never below the number of worlds (E. L. Korn and
    B. I. Graubard, "Confidence intervals for proportions with small expected number of
    positive counts estimated from survey data", Survey Methodology 24, 1998; the floor
    is ours). NaN rates are left out.
    """
    known = ~np.isnan(rates)
    size = np.where(known, agents, 0.0)
    worlds, total = known.sum(axis=0), size.sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        rho = _correlation(np.where(known, rates, 0.0), size, worlds, total)
        worth = total / (1 + (total / worlds - 1) * rho)
        shrink = students(total - 1) / students(worlds - 1)
    effective: FloatArray = np.fmax(worth * shrink**2, worlds)
    return effective


def _correlation(
    value: FloatArray, size: FloatArray, worlds: IntArray, total: FloatArray
) -> FloatArray:
    """Return the correlation (C,) of agents in a world, by analysis of variance; 1 if unknown."""
    usual = total / worlds  # agents of the added part of a world
    n, agents = worlds + PRIOR, total + PRIOR * usual
    mean = ((size * value).sum(axis=0) + 0.5 * PRIOR * usual) / agents
    added = 0.5 * PRIOR * usual * ((1 - mean) ** 2 + mean**2)
    squares = (size**2).sum(axis=0) + PRIOR * usual**2
    per_world = (agents - squares / agents) / (n - 1)  # m, corrected
    between = ((size * (value - mean) ** 2).sum(axis=0) + added) / (n - 1)
    within = (size * value * (1 - value)).sum(axis=0) / (agents - n)
    rho = (between - within) / (between + (per_world - 1) * within)
    return np.clip(np.where(np.isfinite(rho), rho, 1.0), 0.0, 1.0)


def students(freedom: FloatArray) -> FloatArray:
    """Return Student's quantile (C,) at 1 − α/2; NaN without a degree of freedom."""
    return np.asarray(stdtrit(freedom, 1 - ALPHA / 2), dtype=np.float64)


def trimmed_mean(values: FloatArray, share: float) -> FloatArray:
    """Return the mean along the first axis without the share ``share`` at either end."""
    cut = int(share * len(values))
    middle: FloatArray = np.sort(values, axis=0)[cut : len(values) - cut].mean(axis=0)
    return middle


def resample(count: int, rng: np.random.Generator) -> CountArray:
    """Return how often (R, n) each of ``count`` units is in each bootstrap resample."""
    counts = np.empty((RESAMPLES, count), np.uint8 if count < 256 else np.uint16)
    for row in counts:  # one row at a time stays in the processor's cache
        row[:] = np.bincount(rng.integers(count, size=count), minlength=count)
    return counts


def resampled_means(values: FloatArray, counts: CountArray) -> FloatArray:
    """Return means (R, C) of the columns of (n, C) in resamples (R, n), without NaN values.

    Units without a value are resampled as well, because a new draw of seeds would leave
    another number of them undefined. A resample without any value (rarer than
    e⁻ᵏ for k values) repeats the mean.
    """
    known = ~np.isnan(values)
    total = _weighted(counts, np.where(known, values, 0.0))
    if known.all():
        return total
    share = _weighted(counts, known.astype(np.float64))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(share > 0, total / share, mean(values))


def _weighted(counts: CountArray, values: FloatArray) -> FloatArray:
    """Return the products (R, C) of the weights of units in resamples and their values (n, C).

    Blocks of 64 rows or a multiple of them keep the order in which BLAS adds.
    """
    rows = max(64, _BLOCK // max(1, counts.shape[1]) // 64 * 64)
    blocks = (counts[k : k + rows] / float(counts.shape[1]) for k in range(0, len(counts), rows))
    return np.concatenate([weights @ values for weights in blocks])


def mean(values: FloatArray) -> FloatArray:
    """Return the mean (C,) of the columns of (n, C), without NaN values; NaN if none is left."""
    known = ~np.isnan(values)
    with np.errstate(invalid="ignore"):
        found: FloatArray = np.where(known, values, 0.0).sum(axis=0) / known.sum(axis=0)
    return found


def cumulants(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return Σ(x − x̄)² (C,) and Σ(x − x̄)³ (C,) of the columns of (n, C), without NaN values."""
    centred = np.nan_to_num(values - mean(values), nan=0.0)
    return (centred**2).sum(axis=0), (centred**3).sum(axis=0)


def bca(
    means: FloatArray,
    estimate: FloatArray,
    acceleration: FloatArray,
    count: FloatArray,
    freedom: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return the bias-corrected, accelerated, expanded bootstrap interval (C,), (C,).

    ``means`` (R, C) are resampled estimates of ``estimate`` (C,), ``count`` (C,) is the number of
    values of a stratum (the smallest of all strata), and ``freedom`` (C,) the number of values
    minus the number of strata. The correction is that of B. Efron, "Better bootstrap confidence
    intervals", JASA 82 (1987). The expansion, by which the normal quantile becomes
    √(n/(n − 1)) times Student's, is that of T. C. Hesterberg, "What teachers should know
    about the bootstrap", The American Statistician 69 (2015); their combination is ours.
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
    """Return the corrected normal quantile (C,); beyond the pole of the formula, the extreme."""
    pole = 1 - acceleration * side
    return np.where(pole > 0, bias + side / np.where(pole > 0, pole, 1.0), np.sign(side) * np.inf)


def _quantile(ordered: FloatArray, level: FloatArray) -> FloatArray:
    """Return the quantile (C,) of each sorted row (C, R) at its own level (C,), interpolated."""
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
    """Return the interval of the mean of (S,) independent estimates, from their own intervals.

    G. Y. Zou, W. Huang and X. Zhang, "A note on confidence interval estimation for a
    linear function of binomial proportions", Computational Statistics & Data Analysis 53
    (2009). So strata in which every episode succeeded, or every one failed, keep the
    width of their own interval. The result is limited to the metric's range ``least`` to ``most``.
    """
    mean = float(value.mean())
    down = float(np.sqrt(((value - low) ** 2).sum())) / len(value)
    up = float(np.sqrt(((high - value) ** 2).sum())) / len(value)
    return max(mean - down, least), min(mean + up, most)
