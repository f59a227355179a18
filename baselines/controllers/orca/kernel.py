"""Optimal reciprocal collision avoidance for every agent of a batch.

Rows N are (world, agent) pairs, run by `benchnav.threads.run_rows`, and independent of
each other. Arrays are plain arguments, because Numba counts references
to the members of a tuple on every access.
"""

import math

import numpy as np

from benchnav.arena import Kind
from benchnav.arrays import BoolArray, ByteArray, FloatArray, IntArray
from benchnav.kernels import kernel, kernel_without_allocation

from .half_plane import covers, edge_half_plane, neighbour_half_plane
from .program import least_excess, nearest_permitted

_MOVER = int(Kind.DYNAMIC)
OWN = 9  # columns: x, y, vx, vy, preferred vx, preferred vy, radius, speed limit, 1 / step


@kernel_without_allocation
def prepare(
    low: int, high: int, position: FloatArray, velocity: FloatArray, target: FloatArray,
    limits: FloatArray, offset: FloatArray, own: FloatArray,
) -> None:  # fmt: skip
    """Fill rows low … high - 1 of ``own`` (N, 9), see `OWN`.

    The preferred velocity leads straight to the target, not past it within a step.

    Args:
        low: first row.
        high: one past the last row.
        position: (N, 2) [m].
        velocity: (N, 2) [m/s].
        target: (N, 2) [m].
        limits: (N, 4) radius [m], speed limit, preferred speed [m/s], step [s].
        offset: (N, 2) error of both velocities, as a share of the speeds.
        own: (N, 9).
    """
    for i in range(low, high):
        step = limits[i, 3] if limits[i, 3] > 0.0 else 1.0
        dx, dy = target[i, 0] - position[i, 0], target[i, 1] - position[i, 1]
        distance = math.sqrt(dx * dx + dy * dy)
        speed = min(limits[i, 2], distance / step)
        scale = speed / distance if distance > 0.0 else 0.0
        own[i, 0], own[i, 1] = position[i, 0], position[i, 1]
        own[i, 2] = velocity[i, 0] + limits[i, 2] * offset[i, 0]
        own[i, 3] = velocity[i, 1] + limits[i, 2] * offset[i, 1]
        own[i, 4] = scale * dx + speed * offset[i, 0]
        own[i, 5] = scale * dy + speed * offset[i, 1]
        own[i, 6], own[i, 7], own[i, 8] = limits[i, 0], limits[i, 1], 1.0 / step


@kernel_without_allocation
def edge_rows(
    i: int, px: float, py: float, vx: float, vy: float, radius: float, rate: float,
    start: FloatArray, end: FloatArray, before: FloatArray, after: FloatArray,
    start_convex: BoolArray, end_convex: BoolArray, count: int, planes: FloatArray,
) -> int:  # fmt: skip
    """Write the half-planes of agent i's edges; return their number."""
    n = 0
    for k in range(count):
        ax, ay = start[i, k, 0] - px, start[i, k, 1] - py
        bx, by = end[i, k, 0] - px, end[i, k, 1] - py
        covered = False
        for j in range(n):
            row = (planes[j, 0], planes[j, 1], planes[j, 2], planes[j, 3])
            if covers(row, ax, ay, bx, by, radius, rate):
                covered = True
                break
        if covered:
            continue
        made, row = edge_half_plane(
            ax, ay, bx, by,
            before[i, k, 0], before[i, k, 1], after[i, k, 0], after[i, k, 1],
            start_convex[i, k], end_convex[i, k], vx, vy, radius, rate,
        )  # fmt: skip
        if made:
            planes[n, 0], planes[n, 1], planes[n, 2], planes[n, 3] = row
            n += 1
    return n


@kernel
def avoid(
    low: int, high: int, own: FloatArray, active: BoolArray,
    position: FloatArray, velocity: FloatArray, radius: FloatArray, kind: ByteArray,
    count: IntArray,
    start: FloatArray, end: FloatArray, before: FloatArray, after: FloatArray,
    start_convex: BoolArray, end_convex: BoolArray, edge_count: IntArray,
    most: int, margin: float, edge_margin: FloatArray, rate: float, edge_rate: float,
    answer: FloatArray,
) -> None:  # fmt: skip
    """Write new velocities [m/s] into rows low … high - 1 of ``answer`` (N, 2).

    Rows of inactive agents are not changed.

    Args:
        low: first row.
        high: one past the last row.
        own: (N, 9) see `OWN`.
        active: (N,).
        position: (N, K, 2) of neighbours [m], nearest first.
        velocity: (N, K, 2) [m/s].
        radius: (N, K) [m].
        kind: (N, K) Kind.AGENT shares the effort, Kind.DYNAMIC leaves it to the agent.
        count: (N,) valid neighbours.
        start: (N, E, 2) of edges [m], nearest first, solid to the left.
        end: (N, E, 2) [m].
        before: (N, E, 2) unit direction of the previous edge.
        after: (N, E, 2) unit direction of the next edge.
        start_convex: (N, E).
        end_convex: (N, E).
        edge_count: (N,) valid edges.
        most: largest number of neighbours to use.
        margin: [m] added to every disc beside neighbours.
        edge_margin: (N,) [m] added to the agent's own disc at edges.
        rate: 1 / time horizon for neighbours [1/s].
        edge_rate: 1 / time horizon for edges [1/s].
        answer: (N, 2).
    """
    size = position.shape[1] + start.shape[1]
    planes, projected = np.empty((size, 4)), np.empty((size, 4))
    _avoid_in_rows(
        low, high, own, active, position, velocity, radius, kind, count, start, end, before, after,
        start_convex, end_convex, edge_count, most, margin, edge_margin, rate, edge_rate, answer,
        planes, projected,
    )  # fmt: skip


@kernel_without_allocation
def _avoid_in_rows(
    low: int, high: int, own: FloatArray, active: BoolArray,
    position: FloatArray, velocity: FloatArray, radius: FloatArray, kind: ByteArray,
    count: IntArray,
    start: FloatArray, end: FloatArray, before: FloatArray, after: FloatArray,
    start_convex: BoolArray, end_convex: BoolArray, edge_count: IntArray,
    most: int, margin: float, edge_margin: FloatArray, rate: float, edge_rate: float,
    answer: FloatArray, planes: FloatArray, projected: FloatArray,
) -> None:  # fmt: skip
    for i in range(low, high):
        if not active[i]:
            continue
        px, py, vx, vy, wx, wy = own[i, 0], own[i, 1], own[i, 2], own[i, 3], own[i, 4], own[i, 5]
        own_radius, speed, step_rate = own[i, 6], own[i, 7], own[i, 8]
        fixed = 0
        if edge_count[i] > 0:
            fixed = edge_rows(
                i, px, py, vx, vy, own_radius + edge_margin[i], edge_rate, start, end, before,
                after, start_convex, end_convex, edge_count[i], planes,
            )  # fmt: skip
        n = fixed
        for k in range(min(count[i], most)):
            row = neighbour_half_plane(
                position[i, k, 0] - px, position[i, k, 1] - py,
                vx - velocity[i, k, 0], vy - velocity[i, k, 1], vx, vy,
                own_radius + margin + margin + radius[i, k], rate, step_rate,
                1.0 if kind[i, k] == _MOVER else 0.5,
            )  # fmt: skip
            planes[n, 0], planes[n, 1], planes[n, 2], planes[n, 3] = row
            n += 1
        reached, x, y = nearest_permitted(planes, n, speed, wx, wy, False)
        if reached < n:
            x, y = least_excess(planes, n, fixed, reached, speed, x, y, projected)
        answer[i, 0], answer[i, 1] = x, y
