"""The social force model for every agent of a batch, see `force` for its source.

Rows N are (world, agent) pairs and independent of each other.
"""

import math
from typing import NamedTuple

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.kernels import kernel

from .force import LEAST, border_force, pedestrian_force, sight


class Forces(NamedTuple):
    """Parameters of the model: plain numbers, which cost a kernel nothing to hold in a tuple."""

    border_body: float  # [m] radius of the bodies for which borders act on the centre's distance
    relaxation: float  # τ [s]
    pedestrians: float  # V⁰ [m²/s²]
    pedestrian_range: float  # σ [m]
    stride: float  # Δt [s], the time that a step takes
    borders: float  # U⁰ [m²/s²]
    border_range: float  # R [m]
    cosine: float  # of half the angle of sight
    behind: float  # c, the weight of sources out of sight
    top: float  # largest speed, as a multiple of the preferred one
    tick: float  # [s] at most


@kernel
def social_force(
    low: int, high: int, active: BoolArray, here: FloatArray, moving: FloatArray,
    target: FloatArray, body: FloatArray, push: FloatArray,
    position: FloatArray, velocity: FloatArray, radius: FloatArray, count: IntArray,
    start: FloatArray, end: FloatArray, before: FloatArray, after: FloatArray, edges: IntArray,
    forces: Forces, answer: FloatArray,
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
        body: (N, 6) see `baselines.common.kernel_inputs.BODY`.
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
        forces: parameters of the model.
        answer: (N, 2).
    """
    points = np.empty((start.shape[1], 2))
    for i in range(low, high):
        if not active[i]:
            continue
        x, y, vx, vy = here[i, 0], here[i, 1], moving[i, 0], moving[i, 1]
        preferred, step = body[i, 2], body[i, 4]
        limit = min(forces.top * preferred, body[i, 1])
        ticks = max(math.ceil(step / forces.tick - 1e-9), 1)
        h = step / ticks
        keep = math.exp(-h / forces.relaxation)
        for k in range(ticks):
            dx, dy = target[i, 0] - x, target[i, 1] - y
            distance = math.sqrt(dx * dx + dy * dy)
            ex, ey = (dx / distance, dy / distance) if distance > 0.0 else (0.0, 0.0)
            desired = min(preferred, distance / step) if step > 0.0 else preferred
            fx, fy = border_force(
                x, y, body[i, 0] - forces.border_body, start[i], end[i], before[i], after[i],
                edges[i], forces.borders, forces.border_range, points,
            )  # fmt: skip
            for j in range(count[i]):
                ux, uy = velocity[i, j, 0], velocity[i, j, 1]
                rx, ry = x - position[i, j, 0] - k * h * ux, y - position[i, j, 1] - k * h * uy
                apart = math.sqrt(rx * rx + ry * ry)
                excess = body[i, 0] + radius[i, j]  # distances between rims
                scale = max(apart - excess, LEAST) / max(apart, LEAST)
                gx, gy = pedestrian_force(
                    scale * rx,
                    scale * ry,
                    forces.stride * ux,
                    forces.stride * uy,
                    forces.pedestrians,
                    forces.pedestrian_range,
                )
                weight = sight(gx, gy, ex, ey, forces.cosine, forces.behind)
                fx += weight * gx
                fy += weight * gy
            wx = desired * ex + forces.relaxation * (fx + push[i, 0])  # where v would end
            wy = desired * ey + forces.relaxation * (fy + push[i, 1])
            vx, vy = wx + (vx - wx) * keep, wy + (vy - wy) * keep
            speed = math.sqrt(vx * vx + vy * vy)
            if speed > limit:
                vx, vy = vx * limit / speed, vy * limit / speed
            x += vx * h
            y += vy * h
        answer[i, 0], answer[i, 1] = vx, vy
