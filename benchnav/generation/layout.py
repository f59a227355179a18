"""Draw layouts: mazes and rooms, as walls with thickness."""

import numpy as np

from benchnav.arena.solid import Kind, Solid
from benchnav.arrays import BoolArray, Extent
from benchnav.generation.solids import polygon_solids
from benchnav.scenario.wall import Layout, Maze

Span = tuple[float, float]


def draw_layout(layout: Layout, bounds: Extent, rng: np.random.Generator) -> list[Solid]:
    """Return the walls, merged where they meet, so that no edge lies inside another wall."""
    import shapely

    columns, rows = layout.columns, layout.rows
    xs = np.linspace(bounds[0], bounds[2], columns + 1)
    ys = np.linspace(bounds[1], bounds[3], rows + 1)
    share = layout.loops if isinstance(layout, Maze) else layout.extra_doors
    right, up = _passages(columns, rows, share, rng)
    half = 0.5 * layout.thickness
    boxes = []
    for c in range(columns - 1):  # vertical walls, to the right of column c
        for r in range(rows):
            for low, high in _pieces(layout, (ys[r], ys[r + 1]), bool(right[c, r]), rng):
                boxes.append((xs[c + 1] - half, low, xs[c + 1] + half, high))
    for r in range(rows - 1):  # horizontal walls, above row r
        for c in range(columns):
            for low, high in _pieces(layout, (xs[c], xs[c + 1]), bool(up[c, r]), rng):
                boxes.append((low, ys[r + 1] - half, high, ys[r + 1] + half))
    if not boxes:
        return []
    corners = np.clip(np.array(boxes), [*bounds[:2]] * 2, [*bounds[2:]] * 2)
    blocked = shapely.union_all(shapely.box(*corners.T))
    return polygon_solids(shapely.simplify(blocked, 0.0), Kind.WALL)


def _pieces(layout: Layout, span: Span, passage: bool, rng: np.random.Generator) -> list[Span]:
    """Return the pieces of the wall along ``span``: all, none (maze) or the parts beside a door."""
    half = 0.5 * layout.thickness
    low, high = float(span[0]) - half, float(span[1]) + half
    if not passage:
        return [(low, high)]
    if isinstance(layout, Maze):
        return []
    room = (span[1] - span[0]) - layout.thickness - layout.door
    start = span[0] + half + room * rng.random()
    return [(low, start), (start + layout.door, high)]


def _passages(
    columns: int, rows: int, share: float, rng: np.random.Generator
) -> tuple[BoolArray, BoolArray]:
    """Draw a spanning tree of the cells (Kruskal 1956, shuffled edges), and extra passages.

    Returns:
        (columns, rows) whether a cell is connected to its right, and to its upper neighbour.
    """
    cell = np.arange(columns * rows).reshape(columns, rows)
    pairs = np.vstack(
        [
            np.column_stack([cell[:-1].ravel(), cell[1:].ravel()]),
            np.column_stack([cell[:, :-1].ravel(), cell[:, 1:].ravel()]),
        ]
    )
    parent = list(range(columns * rows))

    def root(c: int) -> int:
        while parent[c] != c:
            parent[c] = parent[parent[c]]
            c = parent[c]
        return c

    joined = [np.zeros(columns * rows, np.bool_), np.zeros(columns * rows, np.bool_)]
    spare = []
    for a, b in pairs[rng.permutation(len(pairs))].tolist():
        side = 0 if b - a == rows else 1  # a cell is column × rows + row
        if root(a) == root(b):
            spare.append((side, a))
            continue
        parent[root(a)] = root(b)
        joined[side][a] = True
    for side, a in spare[: round(share * len(spare))]:
        joined[side][a] = True
    return joined[0].reshape(columns, rows), joined[1].reshape(columns, rows)
