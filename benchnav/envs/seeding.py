"""Conversion of seeds for Gymnasium and PettingZoo."""

from collections.abc import Sequence

import numpy as np

from benchnav.errors import UsageError


def plain_seed(seed: int | None) -> int | None:
    """Return ``seed`` as a Python integer, because Gymnasium refuses the integers of NumPy."""
    return int(seed) if isinstance(seed, np.integer) else seed


def joint_seed(seeds: Sequence[int | None], count: int) -> tuple[int, ...] | None:
    """Return a joint seed of environments that share worlds, from their seeds; None if all are.

    Raises UsageError if there are not ``count`` seeds, only some are None, or one is below 0.
    """
    if len(seeds) != count:
        raise UsageError(f"A list of seeds must have {count}, one for each. Got {len(seeds)}.")
    given = tuple(int(seed) for seed in seeds if seed is not None)
    if not given:
        return None
    if len(given) < count:
        raise UsageError(
            "The seeds of a list must be all None or all numbers: agents share worlds, so none"
            f" can be seeded alone. Got {len(given)} numbers and {count - len(given)} times None."
        )
    if min(given) < 0:
        raise UsageError(f"Every seed must be 0 or more. Got {min(given)} instead.")
    return given
