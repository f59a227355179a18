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


Span = tuple[int, int]
"""first, stop"""
Spans = Iterable[Span]
"""Sorted by first."""


def without(wanted: Spans, held: Spans) -> list[Span]:
    """Return the spans of what is in ``wanted`` and not in ``held``, whose spans may overlap."""
    left: list[Span] = []
    taken = iter(held)
    first_held, stop_held = next(taken, (SEED_END, SEED_END))
    for first, stop in wanted:
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
    """Return the spans of what is in any of ``held``, none of which touch."""
    found: list[Span] = []
    for first, stop in held:
        if found and first <= found[-1][1]:
            found[-1] = found[-1][0], max(found[-1][1], stop)
        else:
            found.append((first, stop))
    return found


def twice(held: Spans) -> list[Span]:
    """Return the spans of what is in more than one of ``held``."""
    overlaps: list[Span] = []
    end = -1
    for first, stop in held:
        if first < end:
            overlaps.append((first, min(stop, end)))
        end = max(end, stop)
    return union(overlaps)


def count(of: Spans) -> int:
    """Return how many seeds there are in spans that do not overlap."""
    return sum(stop - first for first, stop in of)
