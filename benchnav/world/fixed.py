"""Geometry that is immobile within an episode, in one grid per arena.

Worlds that share their solids share one entry (a map is stored once). Every cell lists all
capsules within the margin, so that one cell contains everything that a body in it
can touch in a substep.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from benchnav.arena.world import World
from benchnav.arrays import AnyArray, IntArray
from benchnav.geometry.capsule import nearest_on_segment
from benchnav.kernels import inlined, kernel, kernel_without_allocation
from benchnav.world.records import CAPSULE, capsule_records

MAX_CELLS = 1 << 16  # of one arena's grid


def stack_fixed(
    worlds: Sequence[World], records: AnyArray, margin: float
) -> tuple[AnyArray, IntArray, IntArray]:
    """Return (capsules, start, item) of a batch; write the grids' frames into the WORLD records.

    Cell c of a world lists item[start[grid + c] : start[grid + c + 1]], indices into
    capsules. A cell's list reaches ``margin`` [m] beyond the cell.
    """
    arenas: dict[tuple[int, ...], int] = {}
    capsules: list[AnyArray] = []
    count = cells = 0
    frames: list[int] = []  # the first world of each arena
    for b, world in enumerate(worlds):
        key = tuple(id(solid) for solid in world.solids)
        known = arenas.setdefault(key, b)
        row = records[b]
        if known != b:
            for name in ("origin_x", "origin_y", "side", "nx", "ny", "grid", "first", "last"):
                row[name] = records[known][name]
            continue
        part = capsule_records(world.solids, range(len(world.solids)), count)
        capsules.append(part)
        row["first"], row["last"] = count, count + len(part)
        count += len(part)
        _frame(row, world, part, margin)
        row["grid"] = cells
        cells += int(row["nx"] * row["ny"]) + 1
        frames.append(b)
    flat = np.concatenate([np.zeros(0, CAPSULE), *capsules], dtype=CAPSULE)
    start = np.zeros(cells, np.int64)
    item = _fill(records[frames], flat, start, margin)
    return flat, start, item


def _frame(row: Any, world: World, capsules: AnyArray, margin: float) -> None:
    """Write origin, cell size and shape of a grid that covers everything a body can touch."""
    x0, y0, x1, y1 = world.bounds
    if len(capsules):
        r = capsules["r"]
        x0 = min(x0, float((np.minimum(capsules["x0"], capsules["x1"]) - r).min()))
        y0 = min(y0, float((np.minimum(capsules["y0"], capsules["y1"]) - r).min()))
        x1 = max(x1, float((np.maximum(capsules["x0"], capsules["x1"]) + r).max()))
        y1 = max(y1, float((np.maximum(capsules["y0"], capsules["y1"]) + r).max()))
    x0, y0, x1, y1 = x0 - margin, y0 - margin, x1 + margin, y1 + margin
    side = max(1.0, margin) if len(capsules) else max(x1 - x0, y1 - y0)
    side = max(side, math.sqrt((x1 - x0) * (y1 - y0) / MAX_CELLS))
    row["origin_x"], row["origin_y"], row["side"] = x0, y0, side
    row["nx"] = max(1, math.ceil((x1 - x0) / side))
    row["ny"] = max(1, math.ceil((y1 - y0) / side))


@kernel
def _fill(worlds: AnyArray, capsules: AnyArray, start: IntArray, margin: float) -> IntArray:
    """Count items, then place them, by the same test; fill ``start`` and return the items."""
    for g in range(len(worlds)):
        world = worlds[g]
        for p in range(world.first, world.last):
            _list_capsule(world, capsules[p], p, margin, start, start[:0])
    total = 0
    for c in range(len(start)):
        n = start[c]
        start[c] = total
        total += n
    item = np.empty(total, np.int64)
    cursor = start.copy()
    for g in range(len(worlds)):
        world = worlds[g]
        for p in range(world.first, world.last):
            _list_capsule(world, capsules[p], p, margin, cursor, item)
    return item


@kernel_without_allocation
def _list_capsule(
    world: Any, capsule: Any, p: int, margin: float, cursor: IntArray, item: IntArray
) -> None:
    """Raise the cursor of every cell within reach; write the item there if there is space."""
    side = world.side
    ax, ay = capsule.x0 - world.origin_x, capsule.y0 - world.origin_y
    bx, by = capsule.x1 - world.origin_x, capsule.y1 - world.origin_y
    box = capsule.r + margin
    limit = box + 0.7071067811865476 * side * (1.0 + 1e-9)  # from a cell's centre to its corner
    i0 = max(0, int((min(ax, bx) - box) / side))
    i1 = min(world.nx - 1, int((max(ax, bx) + box) / side))
    j0 = max(0, int((min(ay, by) - box) / side))
    j1 = min(world.ny - 1, int((max(ay, by) + box) / side))
    for i in range(i0, i1 + 1):
        for j in range(j0, j1 + 1):
            cx, cy = (i + 0.5) * side, (j + 0.5) * side
            qx, qy = nearest_on_segment(cx, cy, ax, ay, bx, by)
            if (cx - qx) * (cx - qx) + (cy - qy) * (cy - qy) <= limit * limit:
                at = world.grid + i * world.ny + j
                if len(item):
                    item[cursor[at]] = p
                cursor[at] += 1


@kernel_without_allocation
def cell_at(world: Any, x: float, y: float) -> int:
    """Return the index into ``start`` of the cell of (x, y), or of the cell nearest to it."""
    i = math.floor((x - world.origin_x) / world.side)
    j = math.floor((y - world.origin_y) / world.side)
    i = min(max(i, 0), world.nx - 1)
    j = min(max(j, 0), world.ny - 1)
    return int(world.grid + i * world.ny + j)


@inlined
def walk(
    world: Any, x: float, y: float, dx: float, dy: float
) -> tuple[int, int, int, int, float, float, float, float]:
    """Return the parameters of a grid walk from (x, y) along (dx, dy) (Amanatides & Woo 1987).

    They are (i, j) of the first cell, the steps to the next column and row, the multiples of
    (dx, dy) at which these are entered, and the increments of these multiples. The walk enters a
    column if its multiple is the smaller one, else a row.
    """
    side = world.side
    i = math.floor((x - world.origin_x) / side)
    j = math.floor((y - world.origin_y) / side)
    next_i = ((i + (dx > 0.0)) * side + world.origin_x - x) / dx if dx != 0.0 else math.inf
    next_j = ((j + (dy > 0.0)) * side + world.origin_y - y) / dy if dy != 0.0 else math.inf
    each_i = side / abs(dx) if dx != 0.0 else math.inf
    each_j = side / abs(dy) if dy != 0.0 else math.inf
    return i, j, 1 if dx > 0.0 else -1, 1 if dy > 0.0 else -1, next_i, next_j, each_i, each_j
