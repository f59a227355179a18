"""Choose the queries of a ``.scen`` file that become agents, and summarise their lengths."""

from collections import defaultdict, deque

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.scenario.importers.movingai import Queries


def choose(queries: Queries, count: int, bucket: int | None) -> list[int]:
    """Return up to ``count`` rows without repeated starts or goals.

    They are spread evenly over the buckets, because published files list the shortest
    journeys first; within a bucket, and if only one ``bucket`` is requested, the first
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
        row = rows.popleft()  # a row that is refused now would be refused later too
        start, goal = tuple(queries.start[row].tolist()), tuple(queries.goal[row].tolist())
        if start != goal and start not in starts and goal not in goals:
            starts.add(start)
            goals.add(goal)
            return row
    return None


def summary(lengths: FloatArray) -> str:
    """Return the number and lengths [m] of the journeys, as text."""
    if len(lengths) == 1:
        return f"1 journey of {lengths[0]:.1f} m."
    return (
        f"{len(lengths)} journeys: shortest {lengths.min():.1f} m, "
        f"median {np.median(lengths):.1f} m, longest {lengths.max():.1f} m."
    )
