"""Lines of sight: whether the segment from an agent to a point is free of walls and obstacles.

Agents do not block the view. The test uses the same capsules as contacts.
"""

from typing import Any

from benchnav.arrays import AnyArray, IntArray
from benchnav.geometry.capsule import nearest_on_segment, segments_cross
from benchnav.kernels import kernel_without_allocation
from benchnav.world.fixed import walk

FEW = 64  # up to this many capsules, testing all is cheaper than walking the grid


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
    start: IntArray, item: IntArray, bodies: AnyArray, shapes: AnyArray,
) -> bool:  # fmt: skip
    """Whether no wall or obstacle lies between p and q; body ``skip`` (or -1) is ignored."""
    for m in range(world.bodies):
        body = bodies[m]
        nx, ny = nearest_on_segment(body.x, body.y, px, py, qx, qy)
        dx, dy = body.x - nx, body.y - ny
        if m == skip or dx * dx + dy * dy > body.bound * body.bound:
            continue
        for k in range(body.first, body.last):
            if hides(shapes[k], px - body.x, py - body.y, qx - body.x, qy - body.y):
                return False
    if world.last - world.first <= FEW:
        return _clear_of_all(px, py, qx, qy, world, capsules)
    return _clear_along(px, py, qx, qy, world, capsules, start, item)


@kernel_without_allocation
def _clear_of_all(
    px: float, py: float, qx: float, qy: float, world: Any, capsules: AnyArray
) -> bool:
    clear = True
    for p in range(world.first, world.last):
        clear = clear and not hides(capsules[p], px, py, qx, qy)
    return clear


@kernel_without_allocation
def _clear_along(
    px: float, py: float, qx: float, qy: float, world: Any, capsules: AnyArray, start: IntArray,
    item: IntArray,
) -> bool:  # fmt: skip
    """Like `in_sight`, over the cells that pq crosses: a cell lists all capsules that touch it."""
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
