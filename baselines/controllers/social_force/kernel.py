"""The social force model for every agent of a batch, see `force` for its source.

Rows N are (world, agent) pairs and independent of each other.
"""

import math

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.kernels import kernel

from .force import LEAST, border_force, pedestrian_force, sight


@kernel
def social_force(
    low: int, high: int, active: BoolArray, here: FloatArray, moving: FloatArray,
    target: FloatArray, body: FloatArray, push: FloatArray,
    position: FloatArray, velocity: FloatArray, radius: FloatArray, count: IntArray,
    start: FloatArray, end: FloatArray, before: FloatArray, after: FloatArray, edges: IntArray,
    border_body: float, relaxation: float, pedestrians: float, pedestrian_range: float,
    stride: float, borders: float, border_range: float, cosine: float, behind: float, top: float,
    tick: float, answer: FloatArray,
) -> None:  # fmt: skip
    """Write velocities [m/s] after a step into rows low … high - 1 of ``answer`` (N, 2).

    A step is divided into ticks: forces are computed at each, with the neighbours moved on at
    their velocities. Within a tick the relaxation towards the desired velocity is exact.

    Args:
        low: first row.
        high: one past the last row.
        active: (N,) rows to write.
        here: (N, 2) [m].
        moving: (N, 2) velocity [m/s].
        target: (N, 2) [m].
        body: (N, 6) see `baselines.sensed.BODY`.
        push: (N, 2) an acceleration [m/s²] of its own.
        position: (N, K, 2) of neighbours [m].
        velocity: (N, K, 2) [m/s].
        radius: (N, K) [m].
        count: (N,) valid neighbours.
        start: (N, E, 2) of edges [m], solid to the left.
        end: (N, E, 2) [m].
        before: (N, E, 2) unit direction of the previous edge.
        after: (N, E, 2) unit direction of the next edge.
        edges: (N,) valid edges.
        border_body: [m] radius of the bodies for which borders act on the distance of the centre.
        relaxation: τ [s].
        pedestrians: V⁰ [m²/s²].
        pedestrian_range: σ [m].
        stride: Δt [s], the time that a step takes.
        borders: U⁰ [m²/s²].
        border_range: R [m].
        cosine: of half the angle of sight.
        behind: c, the weight of sources out of sight.
        top: largest speed, as a multiple of the preferred one.
        tick: [s] at most.
        answer: (N, 2).
    """
    points = np.empty((start.shape[1], 2))
    for i in range(low, high):
        if not active[i]:
            continue
        x, y, vx, vy = here[i, 0], here[i, 1], moving[i, 0], moving[i, 1]
        preferred, step = body[i, 2], body[i, 4]
        limit = min(top * preferred, body[i, 1])
        ticks = max(math.ceil(step / tick - 1e-9), 1)
        h = step / ticks
        keep = math.exp(-h / relaxation)
        for k in range(ticks):
            dx, dy = target[i, 0] - x, target[i, 1] - y
            distance = math.sqrt(dx * dx + dy * dy)
            ex, ey = (dx / distance, dy / distance) if distance > 0.0 else (0.0, 0.0)
            desired = min(preferred, distance / step) if step > 0.0 else preferred
            fx, fy = border_force(
                x, y, body[i, 0] - border_body, start[i], end[i], before[i], after[i], edges[i],
                borders, border_range, points,
            )  # fmt: skip
            for j in range(count[i]):
                ux, uy = velocity[i, j, 0], velocity[i, j, 1]
                rx, ry = x - position[i, j, 0] - k * h * ux, y - position[i, j, 1] - k * h * uy
                apart = math.sqrt(rx * rx + ry * ry)
                excess = body[i, 0] + radius[i, j]  # distances between rims
                scale = max(apart - excess, LEAST) / max(apart, LEAST)
                gx, gy = pedestrian_force(
                    scale * rx, scale * ry, stride * ux, stride * uy, pedestrians, pedestrian_range
                )
                weight = sight(gx, gy, ex, ey, cosine, behind)
                fx += weight * gx
                fy += weight * gy
            wx = desired * ex + relaxation * (fx + push[i, 0])  # where v would end
            wy = desired * ey + relaxation * (fy + push[i, 1])
            vx, vy = wx + (vx - wx) * keep, wy + (vy - wy) * keep
            speed = math.sqrt(vx * vx + vy * vy)
            if speed > limit:
                vx, vy = vx * limit / speed, vy * limit / speed
            x += vx * h
            y += vy * h
        answer[i, 0], answer[i, 1] = vx, vy
