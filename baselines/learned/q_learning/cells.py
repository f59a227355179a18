"""A grid of cells over a known arena, with the free moves between neighbouring centres."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.geometry import CapsuleGrid, inside_solid, is_clear, solid_index
from benchnav.geometry.capsule_grid import capsule_grid
from benchnav.kernels import kernel
from benchnav.navigation import Map

STEPS = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)])
SKIN = 1e-6  # [m] subtracted from the radius: an agent may be in contact, up to rounding
_MAX_CELLS = 200_000


@dataclass(frozen=True, eq=False)
class Cells:
    """N cells, row by row, and the cells that the eight moves lead to."""

    centre: FloatArray  # (N, 2) [m]
    after: IntArray  # (N, 8) the cell that a move leads to; -1: the move is not free
    cost: FloatArray  # (8,) [m] length of the moves
    side: float  # [m]
    grid: CapsuleGrid  # the obstacles, grown by the disc

    @cached_property
    def usable(self) -> IntArray:
        """The cells with a move, ascending."""
        return np.flatnonzero(self.after.max(axis=1) >= 0)

    def joined(self, place: FloatArray, reach: float) -> IntArray:
        """Return cells with a move and a centre within ``reach`` [m] of a place, nearest first.

        The disc can move straight between the place and the centre.
        """
        offset = self.centre[self.usable] - place
        away = np.sqrt(offset[:, 0] ** 2 + offset[:, 1] ** 2)
        close = np.flatnonzero(away <= reach)
        near = self.usable[close[np.argsort(away[close], kind="stable")]]
        x, y = float(place[0]), float(place[1])
        clear = [is_clear(self.grid, x, y, *self.centre[n].tolist()) for n in near]
        return near[np.array(clear, np.bool_)]


def lay_cells(map: Map, side: float, radius: float, clearance: float) -> Cells:
    """Return cells of ``side`` [m] over the map's bounds, for a disc; larger ones in a huge arena.

    ``clearance`` [m] is kept on the moves, not on the motion to the first cell.
    """
    low, high = np.array(map.bounds[:2]), np.array(map.bounds[2:])
    side = max(side, math.sqrt(float(np.prod(high - low)) / _MAX_CELLS))
    nx, ny = (int(n) for n in np.maximum(np.ceil((high - low) / side - 1e-9), 1))
    corner = 0.5 * (low + high) - 0.5 * side * np.array([nx, ny])
    index = np.arange(nx * ny)
    centre = corner + side * (np.stack([index % nx, index // nx], axis=1) + 0.5)
    wide = capsule_grid(map.capsules, max(radius + clearance - SKIN, 0.0))
    first, outside = solid_index(map.solids)
    free = _free(wide, map.capsules, first, outside, centre)
    after = _after(wide, centre, free, STEPS, nx, ny)
    cost = side * np.sqrt(np.sum(STEPS.astype(np.float64) ** 2, axis=1))
    return Cells(centre, after, cost, side, capsule_grid(map.capsules, max(radius - SKIN, 0.0)))


@kernel
def _free(
    grid: CapsuleGrid, capsules: FloatArray, first: IntArray, outside: IntArray, centre: FloatArray
) -> BoolArray:
    """Whether the disc is free at each centre, (N,)."""
    free = np.zeros(len(centre), np.bool_)
    for n in range(len(centre)):
        x, y = centre[n, 0], centre[n, 1]
        free[n] = is_clear(grid, x, y, x, y) and not inside_solid(x, y, capsules, first, outside)
    return free


@kernel
def _after(
    grid: CapsuleGrid, centre: FloatArray, free: BoolArray, steps: IntArray, nx: int, ny: int
) -> IntArray:
    """Return (N, 8) as in `Cells`; a motion and its reverse are tested once."""
    after = np.full((nx * ny, 8), -1)
    for n in range(nx * ny):
        for m in range(4):
            i, j = n % nx + steps[m, 0], n // nx + steps[m, 1]
            if not free[n] or i < 0 or i >= nx or j >= ny:
                continue
            k = j * nx + i
            if free[k] and is_clear(grid, centre[n, 0], centre[n, 1], centre[k, 0], centre[k, 1]):
                after[n, m], after[k, m + 4] = k, n
    return after
