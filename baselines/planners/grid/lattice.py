"""The free places of a lattice for a disc, and the free steps between them."""

import math
from typing import NamedTuple

import numpy as np

from benchnav.arrays import AnyArray, Extent, FloatArray
from benchnav.geometry import CapsuleGrid, is_clear
from benchnav.geometry.capsule_grid import capsule_grid
from benchnav.kernels import kernel
from benchnav.threads import run_rows

MAX_CELLS = 4_000_000
# the eight steps, counter-clockwise from +x; step (d + 4) % 8 is the reverse of step d
_DX = np.array([1, 1, 0, -1, -1, -1, 0, 1])
_DY = np.array([0, 1, 1, 1, 0, -1, -1, -1])


class Lattice(NamedTuple):
    """Places (column i, row j) = (x + i cell, y + j cell), place number i + j nx."""

    moves: AnyArray  # (ny, nx) uint8, bit d: the disc may take step d
    x: float  # [m] place 0
    y: float
    cell: float  # [m]
    solids: CapsuleGrid  # grown by the disc's radius


def size_of(frame: Extent, cell: float) -> tuple[int, int]:
    """Return (columns, rows) of a lattice over a frame xmin, ymin, xmax, ymax [m]."""
    x0, y0, x1, y1 = frame
    return math.ceil((x1 - x0) / cell) + 2, math.ceil((y1 - y0) / cell) + 2


def lattice(
    capsules: FloatArray, radius: float, cell: float, frame: Extent,
    corner: tuple[float, float],
) -> Lattice:  # fmt: skip
    """Return the lattice over ``frame``, for a disc of ``radius`` [m] among capsules (P, 5).

    ``corner`` [m] is a corner of four cells, so places lie half a cell from it.
    A step is one of eight and is exact: the disc touches nothing along it. None cuts a
    corner: a diagonal step needs both places beside it to be free. A place deep inside a
    solid counts as free, although no step leads there.
    """
    nx, ny = size_of(frame, cell)
    x = corner[0] + (math.floor((frame[0] - corner[0]) / cell) + 0.5) * cell
    y = corner[1] + (math.floor((frame[1] - corner[1]) / cell) + 0.5) * cell
    solids = capsule_grid(capsules, radius)
    free, half = np.zeros((ny, nx), np.bool_), np.zeros((ny, nx), np.uint8)
    run_rows(_places, ny, solids, x, y, cell, free)
    run_rows(_forward, ny, solids, x, y, cell, free, half)
    moves = np.empty_like(half)
    run_rows(_both_ways, ny, half, moves)
    return Lattice(moves, x, y, cell, solids)


@kernel
def _places(
    low: int, high: int, solids: CapsuleGrid, x: float, y: float, cell: float, free: AnyArray
) -> None:
    for j in range(low, high):
        for i in range(free.shape[1]):
            px, py = x + i * cell, y + j * cell
            free[j, i] = is_clear(solids, px, py, px, py)


@kernel
def _forward(
    low: int, high: int, solids: CapsuleGrid, x: float, y: float, cell: float, free: AnyArray,
    half: AnyArray,
) -> None:  # fmt: skip
    """Set bits 0 to 3 for the steps that lead right or up."""
    ny, nx = free.shape
    for j in range(low, high):
        for i in range(nx):
            if not free[j, i]:
                continue
            px, py = x + i * cell, y + j * cell
            for d in range(4):
                k, m = i + _DX[d], j + _DY[d]
                if k < 0 or k >= nx or m >= ny or not free[m, k]:
                    continue
                if d % 2 == 1 and not (free[j, k] and free[m, i]):
                    continue
                if is_clear(solids, px, py, x + k * cell, y + m * cell):
                    half[j, i] |= 1 << d


@kernel
def _both_ways(low: int, high: int, half: AnyArray, moves: AnyArray) -> None:
    nx = half.shape[1]
    for j in range(low, high):
        for i in range(nx):
            bits = half[j, i]
            for d in range(4):
                k, m = i - _DX[d], j - _DY[d]
                if 0 <= k < nx and m >= 0 and (half[m, k] >> d) & 1 == 1:
                    bits |= 1 << (d + 4)
            moves[j, i] = bits


@kernel
def step(d: int) -> tuple[int, int]:
    """Return (columns, rows) of step d."""
    return _DX[d], _DY[d]


@kernel
def joined(grid: Lattice, px: float, py: float, rings: int) -> tuple[AnyArray, FloatArray]:
    """Return the places around p that the disc can reach straight, and their distances [m].

    One ring consists of the corners of the square of places around p; every further ring
    adds a row or column on each side.
    """
    ny, nx = grid.moves.shape
    i0 = math.floor((px - grid.x) / grid.cell + 1e-9)
    j0 = math.floor((py - grid.y) / grid.cell + 1e-9)
    place, length = np.empty(4 * rings * rings, np.int64), np.empty(4 * rings * rings)
    count = 0
    for j in range(max(j0 - rings + 1, 0), min(j0 + rings + 1, ny)):
        for i in range(max(i0 - rings + 1, 0), min(i0 + rings + 1, nx)):
            qx, qy = grid.x + i * grid.cell, grid.y + j * grid.cell
            if is_clear(grid.solids, px, py, qx, qy):
                place[count] = i + j * nx
                length[count] = math.sqrt((qx - px) * (qx - px) + (qy - py) * (qy - py))
                count += 1
    return place[:count], length[:count]
