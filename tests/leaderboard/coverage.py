"""Coverage of the 95 % intervals by simulation: python -m tests.leaderboard.coverage"""

import numpy as np

from benchnav.leaderboard.estimate import Column, Sample, estimate
from benchnav.leaderboard.interval import resample, resampled_means

SHAPES = {
    "normal": (lambda rng, size: rng.normal(size=size), 0.0),
    "exponential": (lambda rng, size: rng.exponential(size=size), 1.0),
    "log-normal": (lambda rng, size: rng.lognormal(0.0, 1.0, size), np.exp(0.5)),
    "0 in 7 of 10, else exponential": (
        lambda rng, size: rng.exponential(size=size) * (rng.random(size) < 0.3),
        0.3,
    ),
    "SPL: 0 or near 0.9": (
        lambda rng, size: (rng.random(size) < 0.85) * rng.beta(20, 2, size),
        0.85 * 20 / 22,
    ),
}
BOUNDED = ("normal", "exponential", "SPL: 0 or near 0.9")
RATES = tuple((p, agents, mix) for p in (0.5, 0.9, 0.98) for agents, mix in ((1, 0.0), (4, 0.3)))


def covered(shape, worlds, tables, rng):
    """Share of simulated tables whose interval holds the mean."""
    draw, truth = SHAPES[shape]
    values = draw(rng, (worlds, tables))
    most = np.full(tables, 1.0 if shape.startswith("SPL") else np.inf)
    least = np.full(tables, 0.0 if shape.startswith("SPL") else -np.inf)
    column = Column(np.zeros(tables, dtype=bool), least, most)
    sample = Sample(values, np.ones_like(values), resample(worlds, rng))
    found = estimate(sample, column)
    return float(np.mean((found.low <= truth) & (truth <= found.high)))


def covered_by_percentiles(shape, worlds, tables, rng):
    """The same for the plain percentile bootstrap, which the table of docs compares with."""
    draw, truth = SHAPES[shape]
    means = resampled_means(draw(rng, (worlds, tables)), resample(worlds, rng))
    low, high = np.quantile(means, [0.025, 0.975], axis=0)
    return float(np.mean((low <= truth) & (truth <= high)))


def covered_rate(truth, agents, correlation, worlds, tables, rng):
    """The same for a rate: agents that share a world agree more than others."""
    chance = np.full((worlds, tables), truth)
    if correlation:
        weight = (1 - correlation) / correlation  # beta-binomial
        chance = rng.beta(truth * weight, (1 - truth) * weight, (worlds, tables))
    values = rng.binomial(agents, chance) / agents
    column = Column(np.ones(tables, dtype=bool), np.zeros(tables), np.ones(tables))
    size = np.full_like(values, float(agents))
    found = estimate(Sample(values, size, resample(worlds, rng)), column)
    return float(np.mean((found.low <= truth) & (truth <= found.high)))


def main():
    counts = (5, 10, 20, 50, 100)
    print(f"| values of a world | {' | '.join(f'n = {n}' for n in counts)} |")
    print("| --- |" + " --- |" * len(counts))
    for shape in SHAPES:
        for name, method in (
            (shape, covered),
            (f"{shape}, by percentiles", covered_by_percentiles),
        ):
            shares = [method(shape, n, 4000, np.random.default_rng(n)) for n in counts]
            print(f"| {name} | {' | '.join(f'{s:.3f}' for s in shares)} |")
    for p, agents, mix in RATES:
        shares = [covered_rate(p, agents, mix, n, 4000, np.random.default_rng(n)) for n in counts]
        name = f"rate {p}, {agents} agent{'s' * (agents > 1)}, correlation {mix}"
        print(f"| {name} | {' | '.join(f'{s:.3f}' for s in shares)} |")


if __name__ == "__main__":
    main()
