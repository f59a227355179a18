"""A* on a grid: eight directions, no corner cutting."""

import heapq
import math

import numpy as np

ROOT2 = math.sqrt(2.0)
STEPS = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]


def neighbours(blocked):
    """For each free cell: [(cell, step length)]; cells are (column, row)."""
    high, wide = blocked.shape
    free = np.zeros((high + 2, wide + 2), bool)
    free[1:-1, 1:-1] = ~blocked
    table = {}
    for row, column in np.argwhere(~blocked).tolist():
        steps = []
        for dx, dy in STEPS:
            r, c = row + 1, column + 1
            if free[r + dy, c + dx] and free[r, c + dx] and free[r + dy, c]:
                steps.append(((column + dx, row + dy), ROOT2 if dx and dy else 1.0))
        table[column, row] = steps
    return table


def length(table, start, goal):
    """NaN where there is no path."""

    def ahead(cell):
        dx, dy = abs(cell[0] - goal[0]), abs(cell[1] - goal[1])
        return max(dx, dy) + (ROOT2 - 1.0) * min(dx, dy)

    best = {start: 0.0}
    heap = [(ahead(start), 0.0, start)]
    while heap:
        _, far, cell = heapq.heappop(heap)
        if cell == goal:
            return far
        if far > best[cell]:
            continue
        for other, step in table[cell]:
            if far + step < best.get(other, math.inf):
                best[other] = far + step
                heapq.heappush(heap, (far + step + ahead(other), far + step, other))
    return math.nan
