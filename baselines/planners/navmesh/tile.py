"""Square tiles of the plane, each with the triangles of its free space.

The triangles of a tile depend on the capsules that reach it, and on nothing else. A map that grew
has the same tiles as before wherever nothing changed, so only the others are meshed again, and the
result is equal to that from scratch, to the last bit.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import shapely

from benchnav.arrays import Extent, FloatArray, IntArray

from .free_polygon import capsule_polygons

SIDE = 8.0  # [m] of a tile, doubled while there are more than this number along an axis
_MOST = 64
_GRID = 1e-9  # [m] to which corners are rounded: no side is so short that triangles have no area

Tile = tuple[float, int, int, bytes]  # side [m], column, row, capsules that reach it


@dataclass(frozen=True)
class Tiling:
    """Tiles that cover a frame; tile (i, j) begins at (i, j) × side."""

    side: float  # [m]
    first: tuple[int, int]  # column and row of the lower left tile
    count: tuple[int, int]  # columns, rows

    @property
    def cells(self) -> list[tuple[int, int]]:
        """The columns and rows of all tiles, row by row."""
        (i, j), (columns, rows) = self.first, self.count
        return [(i + k % columns, j + k // columns) for k in range(columns * rows)]


def tiling(frame: Extent) -> Tiling:
    """Return the tiles that cover a frame xmin, ymin, xmax, ymax [m]."""
    side = SIDE
    while max(frame[2] - frame[0], frame[3] - frame[1]) > side * _MOST:
        side *= 2.0
    low = math.floor(frame[0] / side), math.floor(frame[1] / side)
    high = math.ceil(frame[2] / side), math.ceil(frame[3] / side)
    return Tiling(side, low, (max(high[0] - low[0], 1), max(high[1] - low[1], 1)))


def tiles_of(capsules: FloatArray, inflation: float, segments: int, tiles: Tiling) -> list[Tile]:
    """Return the tiles with the capsules (P, 5) whose polygons may reach each, row by row."""
    ordered = capsules[np.lexsort(capsules.T[::-1])]
    different = np.ones(len(ordered), np.bool_)
    different[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    owner, cell = _reached(ordered[different], inflation, segments, tiles)
    rows = ordered[different][owner]
    starts = np.searchsorted(cell, np.arange(tiles.count[0] * tiles.count[1] + 1)).tolist()
    return [
        (tiles.side, i, j, rows[starts[k] : starts[k + 1]].tobytes())
        for k, (i, j) in enumerate(tiles.cells)
    ]


def _reached(
    capsules: FloatArray, inflation: float, segments: int, tiles: Tiling
) -> tuple[IntArray, IntArray]:
    """Return (capsule, number of the tile) of all pairs that may touch, ordered by tile."""
    side, (columns, rows) = tiles.side, tiles.count
    reach = (capsules[:, 4] + inflation) / math.cos(0.25 * math.pi / segments) + _GRID
    ends = capsules[:, :4].reshape(-1, 2, 2) - side * np.array(tiles.first)
    most = np.array([columns - 1, rows - 1])
    low = np.floor((ends.min(axis=1) - reach[:, None]) / side).astype(np.int64).clip(0, most)
    high = np.floor((ends.max(axis=1) + reach[:, None]) / side).astype(np.int64).clip(0, most)
    wide, tall = (high - low + 1).T
    owner = np.repeat(np.arange(len(capsules)), wide * tall)
    rank = np.arange(len(owner)) - np.repeat(np.cumsum(wide * tall) - wide * tall, wide * tall)
    i, j = low[owner, 0] + rank % wide[owner], low[owner, 1] + rank // wide[owner]
    # tiles beside a slanting capsule are within its box, but too far from its axis
    along = ends[:, 1] - ends[:, 0]
    length = np.sqrt((along * along).sum(axis=1))
    middle = (np.stack([i, j], axis=1) + 0.5) * side - ends[owner, 0]
    off = np.abs(along[owner, 0] * middle[:, 1] - along[owner, 1] * middle[:, 0])
    near = off <= (reach[owner] + 0.71 * side) * length[owner]
    owner, cell = owner[near], (i + j * columns)[near]
    order = np.lexsort((owner, cell))
    return owner[order], cell[order]


def triangulated(tiles: Sequence[Tile], inflation: float, segments: int) -> list[FloatArray]:
    """Return the free triangles (T, 3, 2) [m] of each tile, counter-clockwise.

    They are constrained Delaunay triangles of the tile without the polygons around its capsules,
    by shapely, and include the inside of solids that no edge reaches.
    """
    held = [np.frombuffer(tile[3]).reshape(-1, 5) for tile in tiles]
    counts = np.array([len(capsules) for capsules in held])
    grown = np.full((len(tiles), max(counts.max(initial=0), 1)), None, object)
    row, column = np.nonzero(np.arange(grown.shape[1]) < counts[:, None])
    rings = capsule_polygons(np.vstack([np.zeros((0, 5)), *held]), inflation, segments)
    if len(rings):
        grown[row, column] = shapely.polygons(rings)
    low = np.array([(side * i, side * j) for side, i, j, _ in tiles]).reshape(-1, 2)
    side = np.array([tile[0] for tile in tiles])
    squares = shapely.box(low[:, 0], low[:, 1], low[:, 0] + side, low[:, 1] + side)
    blocked = shapely.union_all(grown, axis=1, grid_size=_GRID)
    free = shapely.difference(squares, blocked, grid_size=_GRID)
    return _triangles(free, len(tiles))


def _triangles(free: Any, count: int) -> list[FloatArray]:
    parts, tile = shapely.get_parts(free, return_index=True)
    flat = shapely.get_type_id(parts) == shapely.GeometryType.POLYGON
    found = shapely.constrained_delaunay_triangles(parts[flat])
    triangles, part = shapely.get_parts(found, return_index=True)
    rings = shapely.get_coordinates(triangles).reshape(-1, 4, 2)[:, :3]
    ends = np.searchsorted(tile[flat][part], np.arange(count + 1)).tolist()
    corner = _counter_clockwise(rings)
    return [corner[a:b] for a, b in pairwise(ends)]


def _counter_clockwise(rings: FloatArray) -> FloatArray:
    (ax, ay), (bx, by), (cx, cy) = (rings[:, k].T for k in range(3))
    clockwise = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) < 0.0
    corner = rings.copy()
    corner[clockwise] = rings[clockwise][:, ::-1]
    return np.ascontiguousarray(corner)
