"""Seeds in few numbers, and which there are."""

from collections.abc import Iterable

SEED_DIGITS = 15  # at most, on the command line and in the names of files
SEED_END = 10**SEED_DIGITS - 1  # the last number that a range of seeds may end before


def spans(seeds: Iterable[int]) -> list[list[int]]:
    """[first, stop] of every run of consecutive seeds, sorted."""
    found: list[list[int]] = []
    for seed in sorted(seeds):
        if found and found[-1][1] == seed:
            found[-1][1] = seed + 1
        else:
            found.append([seed, seed + 1])
    return found
