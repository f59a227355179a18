"""Sets of seeds as spans [first, stop]."""

from collections.abc import Iterable

SEED_DIGITS = 15  # at most, on the command line and in file names
SEED_END = 10**SEED_DIGITS - 1  # largest end of a range of seeds


def spans(seeds: Iterable[int]) -> list[list[int]]:
    """Return [first, stop] of every run of consecutive seeds, sorted."""
    found: list[list[int]] = []
    for seed in sorted(seeds):
        if found and found[-1][1] == seed:
            found[-1][1] = seed + 1
        else:
            found.append([seed, seed + 1])
    return found


Span = tuple[int, int]
"""first, stop"""
Spans = Iterable[Span]
"""Sorted by first."""


def without(whole: Spans, held: Spans) -> list[Span]:
    """Return the spans of ``whole`` that are not in ``held``, whose spans may overlap."""
    left: list[Span] = []
    taken = iter(held)
    first_held, stop_held = next(taken, (SEED_END, SEED_END))
    for first, stop in whole:
        while first < stop:
            if stop_held <= first:
                first_held, stop_held = next(taken, (SEED_END, SEED_END))
            elif stop <= first_held:
                left.append((first, stop))
                break
            else:
                if first < first_held:
                    left.append((first, first_held))
                first = stop_held
    return left


def union(held: Spans) -> list[Span]:
    """Return the union of ``held`` as separate spans."""
    found: list[Span] = []
    for first, stop in held:
        if found and first <= found[-1][1]:
            found[-1] = found[-1][0], max(found[-1][1], stop)
        else:
            found.append((first, stop))
    return found


def twice(held: Spans) -> list[Span]:
    """Return the spans that are in more than one span of ``held``."""
    overlaps: list[Span] = []
    end = -1
    for first, stop in held:
        if first < end:
            overlaps.append((first, min(stop, end)))
        end = max(end, stop)
    return union(overlaps)


def count(of: Spans) -> int:
    """Return the number of seeds in spans that do not overlap."""
    return sum(stop - first for first, stop in of)
