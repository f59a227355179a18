"""A* and Theta* on a lattice.

Theta*: A. Nash, K. Daniel, S. Koenig and A. Felner, "Theta*: any-angle path planning on
grids", AAAI 2007 (basic Theta*). Additions: line of sight is the exact swept test of the
disc, and start and goal need not be places of the lattice but are connected to some.
"""

import math
from typing import NamedTuple

import numpy as np

from benchnav.arrays import AnyArray, FloatArray, IntArray
from benchnav.geometry import doubled, is_clear
from benchnav.geometry.heap import pop, push
from benchnav.kernels import kernel

from .lattice import Lattice, step

_NONE, _START = -2, -1  # parents that are not places


class Ends(NamedTuple):
    """Start and goal, and the places to which each is connected."""

    sx: float  # [m]
    sy: float
    gx: float
    gy: float
    first: IntArray  # places, ascending
    first_length: FloatArray  # [m]
    last: IntArray
    last_length: FloatArray


@kernel
def search(grid: Lattice, ends: Ends, any_angle: bool) -> tuple[FloatArray, int]:
    """Return (path (W, 2) [m] from start to goal, number of sight tests); (0, 2) if there is none.

    Without ``any_angle`` it is A* with the octile distance, and the result is the shortest path
    of steps.
    """
    size = grid.moves.size
    nx = grid.moves.shape[1]
    cost, parent = np.full(size, math.inf), np.full(size, _NONE, np.int32)
    done = np.zeros(size, np.bool_)
    key, item, waiting = np.empty(1024), np.empty(1024, np.int64), 0
    slack = _slack(grid, ends, any_angle)
    best, end, tests = math.inf, _NONE, 0
    for k in range(len(ends.first)):
        n = ends.first[k]
        cost[n], parent[n] = ends.first_length[k], _START
        waiting = push(key, item, waiting, cost[n] + _ahead(grid, ends, n, any_angle, slack), n)
    while waiting > 0 and key[0] < best:
        n = item[0]
        waiting = pop(key, item, waiting)
        if done[n]:
            continue
        done[n] = True
        for k in range(len(ends.last)):
            if ends.last[k] == n:
                total, via = cost[n] + ends.last_length[k], n
                if any_angle:
                    px, py, far = _point(grid, ends, cost, parent[n])
                    tests += 1
                    if is_clear(grid.solids, px, py, ends.gx, ends.gy):
                        total = far + _distance(px, py, ends.gx, ends.gy)
                        via = parent[n]
                if total < best:
                    best, end = total, via
        for d in range(8):
            if (grid.moves[n // nx, n % nx] >> d) & 1 == 0:
                continue
            di, dj = step(d)
            m = n + di + dj * nx
            if done[m]:
                continue
            through, via = cost[n] + grid.cell * math.sqrt(di * di + dj * dj), n
            if any_angle:
                px, py, far = _point(grid, ends, cost, parent[n])
                mx, my, _ = _point(grid, ends, cost, m)
                direct = far + _distance(px, py, mx, my)
                if direct < cost[m]:  # otherwise, the test would change nothing
                    tests += 1
                    if is_clear(grid.solids, px, py, mx, my):
                        through, via = direct, parent[n]
            if through < cost[m]:
                cost[m], parent[m] = through, via
                if waiting == len(key):
                    key, item = doubled(key.reshape(-1, 1)).ravel(), _doubled(item)
                bound = through + _ahead(grid, ends, m, any_angle, slack)
                waiting = push(key, item, waiting, bound, m)
    return _path(grid, ends, cost, parent, end), tests


@kernel
def _doubled(item: IntArray) -> IntArray:
    more = np.empty(2 * len(item), np.int64)
    more[: len(item)] = item
    return more


@kernel
def _point(grid: Lattice, ends: Ends, cost: FloatArray, n: int) -> tuple[float, float, float]:
    """Return x, y [m] of a place or the start, and the cost [m] to reach it."""
    if n == _START:
        return ends.sx, ends.sy, 0.0
    nx = grid.moves.shape[1]
    return grid.x + (n % nx) * grid.cell, grid.y + (n // nx) * grid.cell, cost[n]


@kernel
def _distance(px: float, py: float, qx: float, qy: float) -> float:
    return math.sqrt((qx - px) * (qx - px) + (qy - py) * (qy - py))


@kernel
def _octile(px: float, py: float, qx: float, qy: float) -> float:
    dx, dy = abs(qx - px), abs(qy - py)
    return max(dx, dy) + (math.sqrt(2.0) - 1.0) * min(dx, dy)


@kernel
def _slack(grid: Lattice, ends: Ends, any_angle: bool) -> float:
    """Return by how much [m] the last motion, not a step, may undercut its octile distance."""
    slack = 0.0
    if not any_angle:
        for k in range(len(ends.last)):
            n, nx = ends.last[k], grid.moves.shape[1]
            x, y = grid.x + (n % nx) * grid.cell, grid.y + (n // nx) * grid.cell
            slack = max(slack, _octile(x, y, ends.gx, ends.gy) - ends.last_length[k])
    return slack


@kernel
def _ahead(grid: Lattice, ends: Ends, n: int, any_angle: bool, slack: float) -> float:
    """Return a lower bound [m] of a path from place n to the goal."""
    nx = grid.moves.shape[1]
    x, y = grid.x + (n % nx) * grid.cell, grid.y + (n // nx) * grid.cell
    if any_angle:
        return _distance(x, y, ends.gx, ends.gy)
    return max(0.0, _octile(x, y, ends.gx, ends.gy) - slack)


@kernel
def _path(grid: Lattice, ends: Ends, cost: FloatArray, parent: AnyArray, end: int) -> FloatArray:
    if end == _NONE:
        return np.empty((0, 2))
    count, n = 2, end
    while n != _START:
        n, count = parent[n], count + 1
    path, n = np.empty((count, 2)), end
    path[0, 0], path[0, 1] = ends.sx, ends.sy
    path[count - 1, 0], path[count - 1, 1] = ends.gx, ends.gy
    for k in range(count - 2, 0, -1):
        path[k, 0], path[k, 1], _ = _point(grid, ends, cost, n)
        n = parent[n]
    return path
