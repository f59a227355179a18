"""Slow, obvious twins of outline tracing: flood fill and cell edges."""

import numpy as np


def components(blocked):
    """Sets of 8-connected blocked cells (row, column) of a grid with a blocked rim around it."""
    high, wide = blocked.shape
    rim = {(r, c) for r in (-1, high) for c in range(-1, wide + 1)}
    rim |= {(r, c) for c in (-1, wide) for r in range(-1, high + 1)}
    left = rim | {(int(r), int(c)) for r, c in np.argwhere(blocked)}
    found = []
    while left:
        stack = [left.pop()]
        part = set(stack)
        while stack:
            r, c = stack.pop()
            for cell in ((r + i, c + j) for i in (-1, 0, 1) for j in (-1, 0, 1)):
                if cell in left:
                    left.remove(cell)
                    part.add(cell)
                    stack.append(cell)
        found.append(part)
    return found


def unit_edges(part, blocked):
    """Unit edges ((x, y), (x, y)) between a component and free cells, the component on the left."""
    high, wide = blocked.shape
    edges = set()
    for r, c in part:
        sides = {
            (r - 1, c): ((c, r), (c + 1, r)),
            (r, c + 1): ((c + 1, r), (c + 1, r + 1)),
            (r + 1, c): ((c + 1, r + 1), (c, r + 1)),
            (r, c - 1): ((c, r + 1), (c, r)),
        }
        for (i, j), edge in sides.items():
            if 0 <= i < high and 0 <= j < wide and not blocked[i, j]:
                edges.add(edge)
    return edges
