"""How often 95 % intervals hold the truth.

    python -m studies.interval_coverage [--tables N] [--part rates|differences|means]

Tables are simulated as real ones are: worlds with several agents each, which share their
luck, and two navigators in the same worlds. docs/statistics.md keeps the output for 2,000
tables. Agents of single rates share their luck through a beta distribution of each world.
Single rates of one agent a world need no tables: all outcomes are counted.
"""

from collections.abc import Callable, Iterator
from functools import partial
from itertools import product

import numpy as np
from scipy.stats import binom

from benchmarks.markdown_tables import print_parts
from benchnav.arrays import FloatArray
from benchnav.leaderboard.statistics.difference import Moments, difference
from benchnav.leaderboard.statistics.estimate import Column, Sample, estimate
from benchnav.leaderboard.statistics.interval import mid_p, resample, resampled_means
from studies.simulated_tables import CROWDS, Crowd, unit_rates, world_rates

TABLES = 2000
WORLDS = (50, 100, 200)
RATES = (0.01, 0.02, 0.05, *(k / 10 for k in range(1, 10)), 0.95, 0.98, 0.99)
APART = 0.1  # between the rates of two navigators that differ
WITHIN = (
    0.93,
    0.97,
)  # the required coverage; near 0 and 1 only the lower end, as few worlds decide there
EDGE, DIFFERENCE_EDGE = 0.05, 0.1  # how near, of rates and of their differences


CORRELATIONS = ((1, 0.0), (4, 0.1), (4, 0.3), (10, 0.1))  # agents, correlation within a world


def rates(chance: float, agents: int, correlation: float, shape: tuple[int, int],
          rng: np.random.Generator) -> FloatArray:  # fmt: skip
    """(n, T) world rates: agents that share a world agree as much as ``correlation``."""
    own = np.full(shape, chance)
    if correlation:
        weight = (1 - correlation) / correlation  # beta-binomial
        own = rng.beta(chance * weight, (1 - chance) * weight, shape)
    return rng.binomial(agents, own) / agents


def held(low: FloatArray, high: FloatArray, truth: float) -> float:
    """Share of intervals that hold the truth."""
    return float(np.mean((low <= truth + 1e-12) & (truth <= high + 1e-12)))


def rate_coverage(
    chance: float, tables: int, *, agents: int, correlation: float, worlds: int, seed: int = 1
) -> float:
    """Of the interval of one navigator's rate; exact, by every outcome, with one agent a world."""
    if agents == 1:
        won = np.arange(worlds + 1)
        low, high = mid_p(won / worlds, np.full(worlds + 1, float(worlds)))
        return float(binom.pmf(won, worlds, chance)[(low <= chance) & (chance <= high)].sum())
    rng = np.random.default_rng([seed, worlds, agents])
    value = rates(chance, agents, correlation, (worlds, tables), rng)
    size = np.full_like(value, float(agents))
    found = estimate(Sample(value, size, np.zeros((2, worlds))), unit_rates(tables))
    return held(found.low, found.high, chance)


def difference_coverage(
    chance: float, tables: int, *, apart: float, crowd: Crowd, worlds: int, seed: int = 2
) -> float:
    """Of the interval of the paired difference to a navigator ``apart`` nearer a half."""
    other = round(chance + (apart if chance <= 0.5 else -apart), 9)
    rng = np.random.default_rng([seed, worlds, crowd.agents])
    one, second = world_rates((chance, other), crowd, (worlds, tables), rng)
    found = difference([Moments.of(one - second)], unit_rates(tables))
    return held(found.low, found.high, chance - other)


Draw = Callable[[np.random.Generator, tuple[int, int]], FloatArray]
MEANS: dict[str, tuple[Draw, float]] = {
    "normal": (lambda rng, size: rng.normal(size=size), 0.0),
    "exponential": (lambda rng, size: rng.exponential(size=size), 1.0),
    "log-normal": (lambda rng, size: rng.lognormal(0.0, 1.0, size), float(np.exp(0.5))),
    "0 in 7 of 10, else exponential": (
        lambda rng, size: rng.exponential(size=size) * (rng.random(size) < 0.3),
        0.3,
    ),
    "SPL: 0 or near 0.9": (
        lambda rng, size: (rng.random(size) < 0.85) * rng.beta(20, 2, size),
        0.85 * 20 / 22,
    ),
}


def mean_coverage(shape: str, worlds: int, tables: int, percentiles: bool = False) -> float:
    """Of the interval of a mean; ``percentiles``: of the plain bootstrap, which is not used."""
    rng = np.random.default_rng(worlds)
    draw, truth = MEANS[shape]
    value = draw(rng, (worlds, tables))
    weights = resample(worlds, rng)
    if percentiles:
        low, high = np.quantile(resampled_means(value, weights), [0.025, 0.975], axis=0)
        return held(low, high, truth)
    limit = 1.0 if shape.startswith("SPL") else np.inf
    least = np.full(tables, 0.0 if shape.startswith("SPL") else -np.inf)
    column = Column(np.zeros(tables, dtype=np.bool_), least, np.full(tables, limit))
    found = estimate(Sample(value, np.ones_like(value), weights), column)
    return held(found.low, found.high, truth)


def is_required(chance: float, share: float, edge: float = EDGE) -> bool:
    """Whether a rate has the required coverage; nearer than ``edge`` to 0 or 1, at least."""
    low, high = WITHIN
    return share >= low and (share <= high or not edge <= chance <= 1 - edge)


def cells(
    measure: Callable[[float, int], float], tables: int, edge: float = EDGE
) -> tuple[str, ...]:
    """Coverage at each of `RATES`, and whether all have the required coverage.

    2,000 tables tell a coverage to ± 0.01: what falls outside is measured again (*) with
    ten times as many, and judged by that.
    """
    texts, good = [], True
    for p in RATES:
        share, mark = measure(p, tables), ""
        if not is_required(p, share, edge):
            share, mark = measure(p, 10 * tables), "*"
            good &= is_required(p, share, edge)
        texts.append(f"{share:.3f}{mark}")
    return (*texts, "yes" if good else "no")


Row = tuple[str, ...]


def rate_rows(tables: int) -> Iterator[Row]:
    """Coverage of single rates."""
    yield ("agents, correlation", "worlds", *(f"{p:g}" for p in RATES), "as required")
    for (agents, mix), n in product(CORRELATIONS, WORLDS):
        measure = partial(rate_coverage, agents=agents, correlation=mix, worlds=n)
        yield (f"{agents}, {mix}", f"{n}", *cells(measure, tables))


def difference_rows(tables: int) -> Iterator[Row]:
    """Coverage of paired differences, of equals and of navigators that differ."""
    yield ("crowd", "B", "worlds", *(f"{p:g}" for p in RATES), "as required")
    for crowd, apart, n in product(CROWDS, (0.0, APART), WORLDS):
        measure = partial(difference_coverage, apart=apart, crowd=crowd, worlds=n)
        name = f"{apart:g} nearer ½" if apart else "as A"
        yield (crowd.name, name, f"{n}", *cells(measure, tables, DIFFERENCE_EDGE))


def mean_rows(tables: int) -> Iterator[Row]:
    """Coverage of means of other quantities."""
    counts = (5, 10, 20, 50, 100)
    yield ("values of a world", *(f"n = {n}" for n in counts))
    for shape, plain in product(MEANS, (False, True)):
        shares = [mean_coverage(shape, n, tables, plain) for n in counts]
        yield (f"{shape}{', by percentiles' * plain}", *(f"{s:.3f}" for s in shares))


PARTS = {"rates": rate_rows, "differences": difference_rows, "means": mean_rows}


if __name__ == "__main__":
    print_parts(__doc__.split("\n")[0], PARTS, TABLES)
