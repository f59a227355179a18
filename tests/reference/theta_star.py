"""A* and Theta* (Nash et al. 2007) on a lattice of places, as their pseudo-code reads."""

import heapq
import math

STEPS = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]


def moves(free, motion):
    """{place: [neighbours]} of places (i, j) for which free(place), motion(place, place) say so."""
    table = {}
    for place in free:
        table[place] = []
        for di, dj in STEPS:
            other = (place[0] + di, place[1] + dj)
            beside = {(place[0] + di, place[1]), (place[0], place[1] + dj)}
            if other in free and beside <= free and motion(place, other):
                table[place].append(other)
    return table


def length(table, at, starts, goals, goal, sight=None):
    """Length of the path that is found; inf if there is none.

    Args:
        table: see ``moves``.
        at: {place: (x, y)}, and {"start": (x, y)}.
        starts: {place: distance from the start}.
        goals: {place: distance to the goal}.
        goal: (x, y).
        sight: sight(p, q) of two points, for Theta*; None: A*.
    """
    best = dict(starts)
    parent = dict.fromkeys(starts, "start")
    best["start"] = 0.0
    heap = [(d + math.dist(at[n], goal), n) for n, d in starts.items()]
    heapq.heapify(heap)
    closed, found = set(), math.inf
    while heap and heap[0][0] < found:
        _, n = heapq.heappop(heap)
        if n in closed:
            continue
        closed.add(n)
        if n in goals:
            root = parent[n]
            total = best[n] + goals[n]
            if sight and sight(at[root], goal):
                total = best[root] + math.dist(at[root], goal)
            found = min(found, total)
        for m in table[n]:
            if m in closed:
                continue
            via = parent[n] if sight and sight(at[parent[n]], at[m]) else n
            through = best[via] + math.dist(at[via], at[m])
            if through < best.get(m, math.inf):
                best[m], parent[m] = through, via
                heapq.heappush(heap, (through + math.dist(at[m], goal), m))
    return found
