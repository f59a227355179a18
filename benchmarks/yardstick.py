"""Fixed work that uses nothing of benchnav: loops of Python, and small and large arrays."""

from time import perf_counter

import numpy as np

ROUNDS = 150


def yardstick() -> float:
    """Return how often a second the work is done."""
    began = perf_counter()
    for seed in range(ROUNDS):
        _work(seed)
    return ROUNDS / (perf_counter() - began)


def _work(seed: int) -> float:
    rng = np.random.default_rng(seed)
    large = rng.random(20_000)
    total = float(np.sort(large)[::100].sum())
    for row in large[:3000].reshape(-1, 6):
        total += float(np.hypot(row[:3], row[3:]).max())
    for number in large[:5000].tolist():
        total += number * number
    return total
