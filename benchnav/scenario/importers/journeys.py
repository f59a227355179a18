"""Which queries of a ``.scen`` file become agents, and how far these have to go."""

from collections import defaultdict, deque

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.scenario.importers.movingai import Queries


def choose(queries: Queries, count: int, bucket: int | None) -> list[int]:
    """Return up to ``count`` rows, no two of which share a start or a goal.

    They are spread evenly over the buckets, because published files put the shortest
    journeys first; within a bucket, and where only one ``bucket`` is wanted, the first
    rows are taken.
    """
    by_bucket: defaultdict[int, deque[int]] = defaultdict(deque)
    for row, of in enumerate(queries.bucket.tolist()):
        if bucket is None or of == bucket:
            by_bucket[of].append(row)
    groups = [by_bucket[of] for of in sorted(by_bucket)]
    taken: list[int] = []
    starts: set[tuple[int, ...]] = set()
    goals: set[tuple[int, ...]] = set()
    for agent in range(count):
        home = int((agent + 0.5) * len(groups) / count)
        for group in sorted(range(len(groups)), key=lambda i: abs(i - home)):
            found = _next(queries, groups[group], starts, goals)
            if found is not None:
                taken.append(found)
                break
    return taken


def _next(
    queries: Queries, rows: deque[int], starts: set[tuple[int, ...]], goals: set[tuple[int, ...]]
) -> int | None:
    """Take the first row whose start and goal are not yet in ``starts`` and ``goals``."""
    while rows:
        row = rows.popleft()  # one that is refused now would be refused later too
        start, goal = tuple(queries.start[row].tolist()), tuple(queries.goal[row].tolist())
        if start != goal and start not in starts and goal not in goals:
            starts.add(start)
            goals.add(goal)
            return row
    return None


def summary(lengths: FloatArray) -> str:
    """Return how many journeys there are, and how long [m] they are."""
    if len(lengths) == 1:
        return f"1 journey of {lengths[0]:.1f} m."
    return (
        f"{len(lengths)} journeys: shortest {lengths.min():.1f} m, "
        f"median {np.median(lengths):.1f} m, longest {lengths.max():.1f} m."
    )
