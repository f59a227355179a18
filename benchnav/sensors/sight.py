"""Lines of sight: whether the segment from an agent to a point is free of walls and obstacles.

Agents do not block the view. The test uses the same capsules as contacts.

The fixed capsules of a small world are copied into a table, one row for a coordinate. A test of
all of them then has no branches, and the compiler turns it into vector operations.
"""

from typing import Any

from benchnav.arrays import AnyArray, FloatArray, IntArray
from benchnav.geometry.capsule import nearest_on_segment, segments_cross
from benchnav.kernels import kernel_without_allocation
from benchnav.world.fixed import walk

FEW = 64  # up to this many capsules, testing all is cheaper than walking the grid
PADDED = 16  # the rows of a table are filled up to a multiple of this many capsules
SPARE = 1e-3  # [m] farther than it must be, an obstacle is out of sight, whatever the rounding

# rows of a table, each of FEW numbers: first end, second end, direction, its square, unit normal,
# radius; then as seen by the agent: its side of the line, both ends, and a free row
X0, Y0, X1, Y1, DX, DY, LENGTH2, NX, NY, R, SIDE, FROM_X0, FROM_Y0, FROM_X1, FROM_Y1, FREE = range(
    0, 16 * FEW, FEW
)
TABLE = 16 * FEW  # numbers of a table


@kernel_without_allocation
def copy_fixed(world: Any, capsules: AnyArray, table: FloatArray) -> tuple[int, bool]:
    """Copy the fixed capsules of a world into a table, if they are few.

    Return their number, padded, and whether there are discs; -1 and False if they are many.
    Padding has no length and no radius.
    """
    count, discs = world.last - world.first, False
    if count > FEW:
        return -1, False
    for k in range(count):
        c = capsules[world.first + k]
        dx, dy = c.x1 - c.x0, c.y1 - c.y0
        table[X0 + k], table[Y0 + k], table[X1 + k], table[Y1 + k] = c.x0, c.y0, c.x1, c.y1
        table[DX + k], table[DY + k], table[R + k] = dx, dy, c.r
        table[NX + k], table[NY + k] = c.nx, c.ny
        length2 = dx * dx + dy * dy
        table[LENGTH2 + k] = length2 if length2 > 0.0 else 1.0
        discs = discs or c.r > 0.0
    size = (count + PADDED - 1) // PADDED * PADDED
    for row in range(X0, SIDE, FEW):
        for k in range(row + count, row + size):
            table[k] = 1.0 if row == LENGTH2 else 0.0
    return size, discs


@kernel_without_allocation
def stand_at(px: float, py: float, size: int, table: FloatArray) -> None:
    """Write what does not depend on the points at which an agent at p looks."""
    for k in range(size):
        x0, y0 = table[X0 + k], table[Y0 + k]
        table[SIDE + k] = table[DX + k] * (py - y0) - table[DY + k] * (px - x0)
        table[FROM_X0 + k], table[FROM_Y0 + k] = x0 - px, y0 - py
        table[FROM_X1 + k], table[FROM_Y1 + k] = table[X1 + k] - px, table[Y1 + k] - py


@kernel_without_allocation
def list_blockers(a: Any, limit: float, count: int, bodies: AnyArray, blockers: IntArray) -> int:
    """List bodies that may hide a point within ``limit`` [m] of agent a; return their number."""
    n = 0
    for m in range(count):
        x, y, far = bodies[m].x - a.x, bodies[m].y - a.y, limit + bodies[m].bound + SPARE
        if x * x + y * y <= far * far:
            blockers[n] = m
            n += 1
    return n


@kernel_without_allocation
def hides(c: Any, px: float, py: float, qx: float, qy: float) -> bool:
    """Whether capsule c cuts the open segment pq."""
    if c.r > 0.0:
        nx, ny = nearest_on_segment(c.x0, c.y0, px, py, qx, qy)
        dx, dy = c.x0 - nx, c.y0 - ny
        return bool(dx * dx + dy * dy < c.r * c.r)
    return segments_cross(px, py, qx, qy, c.x0, c.y0, c.x1, c.y1)


@kernel_without_allocation
def in_sight(
    px: float, py: float, qx: float, qy: float, skip: int, world: Any, capsules: AnyArray,
    start: IntArray, item: IntArray, bodies: AnyArray, shapes: AnyArray, size: int, discs: bool,
    table: FloatArray, blocker_count: int, blockers: IntArray,
) -> bool:  # fmt: skip
    """Whether no wall or obstacle lies between p and q; body ``skip`` (or -1) is ignored.

    ``size`` and ``discs`` come from `copy_fixed`; an agent must `stand_at` p. ``blockers`` come
    from `list_blockers`.
    """
    if size >= 0:
        if not _clear_of_edges(px, py, qx, qy, size, table):
            return False
        if discs and not _clear_of_discs(px, py, qx, qy, size, table):
            return False
    elif not _clear_along(px, py, qx, qy, world, capsules, start, item):
        return False
    for n in range(blocker_count):
        m = blockers[n]
        body = bodies[m]
        nx, ny = nearest_on_segment(body.x, body.y, px, py, qx, qy)
        dx, dy = body.x - nx, body.y - ny
        if m == skip or dx * dx + dy * dy > body.bound * body.bound:
            continue
        for k in range(body.first, body.last):
            if hides(shapes[k], px - body.x, py - body.y, qx - body.x, qy - body.y):
                return False
    return True


@kernel_without_allocation
def _clear_of_edges(
    px: float, py: float, qx: float, qy: float, size: int, table: FloatArray
) -> bool:
    """Whether no edge of a table cuts pq: `segments_cross` for all of them. A disc never does."""
    ex, ey, cut = qx - px, qy - py, 0
    for k in range(size):
        side = table[DX + k] * (qy - table[Y0 + k]) - table[DY + k] * (qx - table[X0 + k])
        side_0 = ex * table[FROM_Y0 + k] - ey * table[FROM_X0 + k]
        side_1 = ex * table[FROM_Y1 + k] - ey * table[FROM_X1 + k]
        cut += (table[SIDE + k] * side < 0.0) & (side_0 * side_1 <= 0.0)
    return cut == 0


@kernel_without_allocation
def _clear_of_discs(
    px: float, py: float, qx: float, qy: float, size: int, table: FloatArray
) -> bool:
    """Whether no disc of a table cuts pq: `hides` for all of them. An edge never does."""
    ex, ey, cut = qx - px, qy - py, 0
    length2 = ex * ex + ey * ey
    for k in range(size):
        along = ex * table[FROM_X0 + k] + ey * table[FROM_Y0 + k]
        t = along / length2 if length2 > 0.0 else 0.0
        x = px if along <= 0.0 else (qx if along >= length2 else px + t * ex)
        y = py if along <= 0.0 else (qy if along >= length2 else py + t * ey)
        dx, dy = table[X0 + k] - x, table[Y0 + k] - y
        cut += dx * dx + dy * dy < table[R + k] * table[R + k]
    return cut == 0


@kernel_without_allocation
def _clear_along(
    px: float, py: float, qx: float, qy: float, world: Any, capsules: AnyArray, start: IntArray,
    item: IntArray,
) -> bool:  # fmt: skip
    """Whether no fixed capsule cuts pq, over the cells that pq crosses.

    A cell lists all capsules that touch it.
    """
    i, j, step_i, step_j, next_i, next_j, each_i, each_j = walk(world, px, py, qx - px, qy - py)
    entered = 0.0
    while entered <= 1.0:
        if 0 <= i < world.nx and 0 <= j < world.ny:
            cell = world.grid + i * world.ny + j
            for at in range(start[cell], start[cell + 1]):
                if hides(capsules[item[at]], px, py, qx, qy):
                    return False
        if next_i < next_j:
            entered, next_i, i = next_i, next_i + each_i, i + step_i
        else:
            entered, next_j, j = next_j, next_j + each_j, j + step_j
    return True
