"""Errors of edges: a shift along the normal, misses and field of view."""

import math

import numpy as np

from benchnav.arrays import AnyArray, BoolArray, FloatArray, IntArray
from benchnav.geometry.capsule import nearest_on_segment
from benchnav.geometry.rotation import TWO_PI, cos_sin
from benchnav.kernels import kernel, kernel_without_allocation
from benchnav.sensors.noise.draws import EDGE, draw, two_normals, uniform
from benchnav.sensors.noise.odometry import HEADING, is_exact, placed
from benchnav.sensors.noise.ray_noise import in_view

# columns of a reading: both ends, directions before and after, convexities, squared distance
X0, Y0, X1, Y1, BX, BY, AX, AY, START_CONVEX, END_CONVEX, FAR = range(11)


@kernel
def disturb_edges(
    low: int, high: int, chosen: IntArray, offset_noise: float, missed: float, view: float,
    worlds: AnyArray, agents: AnyArray, keys: AnyArray, error: FloatArray, identity: IntArray,
    start: FloatArray, end: FloatArray, before: FloatArray, after: FloatArray,
    start_convex: BoolArray, end_convex: BoolArray, count: IntArray,
) -> None:  # fmt: skip
    """Add noise to the readings of rows low:high of the flattened (B, chosen agents).

    They stay sorted by distance. An edge is in view if its nearest point, its middle or one of its
    ends is. The other arguments are those of `find_edges`, and the numbers of `EdgeNoise`.
    """
    _disturb_rows(
        low, high, chosen, offset_noise, missed, view, worlds, agents, keys, error, identity,
        start, end, before, after, start_convex, end_convex, count,
        np.empty((start.shape[2] + 1, 11)),
    )  # fmt: skip


@kernel_without_allocation
def _disturb_rows(
    low: int, high: int, chosen: IntArray, offset_noise: float, missed: float, view: float,
    worlds: AnyArray, agents: AnyArray, keys: AnyArray, error: FloatArray, identity: IntArray,
    start: FloatArray, end: FloatArray, before: FloatArray, after: FloatArray,
    start_convex: BoolArray, end_convex: BoolArray, count: IntArray, readings: FloatArray,
) -> None:  # fmt: skip
    width = chosen.shape[1]
    everywhere, (cos_half, _) = view >= TWO_PI, cos_sin(0.5 * view)
    for row in range(low, high):
        b, k = row // width, row % width
        i = chosen[b, k]
        if i < 0 or not agents[b, i].present:
            continue
        a, step = agents[b, i], worlds[b].steps_done
        ca, sa = cos_sin(a.heading)
        n, new = 0, readings[len(readings) - 1]
        for s in range(count[b, k]):
            new[X0], new[Y0] = start[b, k, s, 0], start[b, k, s, 1]
            new[X1], new[Y1] = end[b, k, s, 0], end[b, k, s, 1]
            new[BX], new[BY] = before[b, k, s, 0], before[b, k, s, 1]
            new[AX], new[AY] = after[b, k, s, 0], after[b, k, s, 1]
            new[START_CONVEX] = 1.0 if start_convex[b, k, s] else 0.0
            new[END_CONVEX] = 1.0 if end_convex[b, k, s] else 0.0
            if not everywhere and not _is_in_view(new, a.x, a.y, ca, sa, cos_half):
                continue
            first, second = draw(keys[b, 0], keys[b, 1], step, i, EDGE, identity[b, k, s])
            if uniform(second) < missed:
                continue
            if offset_noise > 0.0:
                _shift(new, offset_noise * two_normals(first)[0])
            x, y = nearest_on_segment(a.x, a.y, new[X0], new[Y0], new[X1], new[Y1])
            new[FAR] = (x - a.x) * (x - a.x) + (y - a.y) * (y - a.y)
            if n > 0 and offset_noise == 0.0:
                new[FAR] = max(new[FAR], readings[n - 1, FAR])  # the order of the sensor
            _insert(n, new, readings)
            n += 1
        _place(n, a.x, a.y, error[b, k], readings)
        _write(
            n, readings, start[b, k], end[b, k], before[b, k], after[b, k], start_convex[b, k],
            end_convex[b, k],
        )  # fmt: skip
        count[b, k] = n


@kernel_without_allocation
def _is_in_view(
    edge: FloatArray, px: float, py: float, ca: float, sa: float, cos_half: float
) -> bool:
    x, y = nearest_on_segment(px, py, edge[X0], edge[Y0], edge[X1], edge[Y1])
    mx, my = 0.5 * (edge[X0] + edge[X1]), 0.5 * (edge[Y0] + edge[Y1])
    return bool(
        in_view(x - px, y - py, ca, sa, cos_half)
        or in_view(mx - px, my - py, ca, sa, cos_half)
        or in_view(edge[X0] - px, edge[Y0] - py, ca, sa, cos_half)
        or in_view(edge[X1] - px, edge[Y1] - py, ca, sa, cos_half)
    )


@kernel_without_allocation
def _shift(edge: FloatArray, by: float) -> None:
    """Move an edge ``by`` [m] along its normal."""
    dx, dy = edge[X1] - edge[X0], edge[Y1] - edge[Y0]
    length = math.sqrt(dx * dx + dy * dy)
    if length > 0.0:
        nx, ny = by * dy / length, -by * dx / length
        edge[X0] += nx
        edge[Y0] += ny
        edge[X1] += nx
        edge[Y1] += ny


@kernel_without_allocation
def _insert(n: int, new: FloatArray, readings: FloatArray) -> None:
    """Insert an edge into n sorted ones, behind those that are as far."""
    at = n
    while at > 0 and readings[at - 1, FAR] > new[FAR]:
        for column in range(11):
            readings[at, column] = readings[at - 1, column]
        at -= 1
    for column in range(11):
        readings[at, column] = new[column]


@kernel_without_allocation
def _place(n: int, own_x: float, own_y: float, e: FloatArray, readings: FloatArray) -> None:
    """Move n edges into the odometry frame."""
    if is_exact(e):
        return
    c, s = cos_sin(e[HEADING])
    for at in range(n):
        edge = readings[at]
        edge[X0], edge[Y0] = placed(edge[X0], edge[Y0], own_x, own_y, c, s, e)
        edge[X1], edge[Y1] = placed(edge[X1], edge[Y1], own_x, own_y, c, s, e)
        bx, by, ax, ay = edge[BX], edge[BY], edge[AX], edge[AY]
        edge[BX], edge[BY] = c * bx - s * by, s * bx + c * by
        edge[AX], edge[AY] = c * ax - s * ay, s * ax + c * ay


@kernel_without_allocation
def _write(
    n: int, readings: FloatArray, start: FloatArray, end: FloatArray, before: FloatArray,
    after: FloatArray, start_convex: BoolArray, end_convex: BoolArray,
) -> None:  # fmt: skip
    """Write n edges; zero behind them."""
    for at in range(len(start)):
        edge = readings[at]
        if at >= n:
            edge[:] = 0.0
        start[at, 0], start[at, 1], end[at, 0], end[at, 1] = edge[X0], edge[Y0], edge[X1], edge[Y1]
        before[at, 0], before[at, 1] = edge[BX], edge[BY]
        after[at, 0], after[at, 1] = edge[AX], edge[AY]
        start_convex[at], end_convex[at] = edge[START_CONVEX] > 0.0, edge[END_CONVEX] > 0.0
