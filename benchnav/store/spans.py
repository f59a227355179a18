"""Seeds in few numbers."""

from collections.abc import Iterable


def spans(seeds: Iterable[int]) -> list[list[int]]:
    """[first, stop] of every run of consecutive seeds, sorted."""
    found: list[list[int]] = []
    for seed in sorted(seeds):
        if found and found[-1][1] == seed:
            found[-1][1] = seed + 1
        else:
            found.append([seed, seed + 1])
    return found
