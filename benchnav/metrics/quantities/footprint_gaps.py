"""Gaps of bodies that are not discs: their true shapes at sampled times, a kernel."""

import numpy as np

from benchnav.arena.agents import Agents
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.geometry.capsule import nearest_on_segment
from benchnav.geometry.rotation import cos_sin, wrap
from benchnav.geometry.segment_sum import distance_to_sum
from benchnav.kernels import kernel, kernel_without_allocation
from benchnav.world.bodies import is_away

SAMPLES = 4  # of each step


def shapes_of(agents: Agents) -> FloatArray:
    """Return half length and half width of the core, and the radius around it, (A, 3) [m]."""
    rounded = agents.rounding > 0.0
    length = np.where(rounded, agents.half_length - agents.rounding, 0.0)
    width = np.where(rounded, agents.half_width - agents.rounding, 0.0)
    return np.stack([length, width, np.where(rounded, agents.rounding, agents.radius)], axis=1)


@kernel
def lower_gaps(
    position: FloatArray, velocity: FloatArray, duration: FloatArray, last: IntArray,
    enters: IntArray, leaves: IntArray, heading: FloatArray, shape: FloatArray,
    radius: FloatArray, dt: float, capsules: FloatArray, body: IntArray, offset: FloatArray,
    jumps: BoolArray,
    clearance: FloatArray, gap: FloatArray,
) -> None:  # fmt: skip
    """Lower ``clearance`` (A,) and ``gap`` (A, T+1) to the gaps of the shapes (A, 3).

    Positions and headings (A, T+1) are interpolated within a step, at SAMPLES times.
    """
    for a in range(len(position)):
        for k in range(enters[a], last[a] + 1):
            for s in range(SAMPLES if k < last[a] else 1):
                t = duration[a, k] * s / SAMPLES if s > 0 else 0.0
                counts = k < last[a] or k == enters[a]
                x, y, angle = _pose(a, k, t, position, velocity, duration, last, heading, dt)
                for c in range(len(capsules)):
                    m, px, py = body[c], x, y
                    if m >= 0:
                        if is_away(offset[m, k, 0], offset[m, k, 1]):
                            continue
                        later = k + 1 if k + 1 < offset.shape[1] and not jumps[m] else k
                        if is_away(offset[m, later, 0], offset[m, later, 1]):
                            later = k  # it stands until it vanishes
                        px -= offset[m, k, 0] + (offset[m, later, 0] - offset[m, k, 0]) * (t / dt)
                        py -= offset[m, k, 1] + (offset[m, later, 1] - offset[m, k, 1]) * (t / dt)
                    x0, y0, x1, y1, r = capsules[c]
                    qx, qy = nearest_on_segment(px, py, x0, y0, x1, y1)
                    far = max(radius[a] + r + clearance[a], 0.0)
                    if not counts or (px - qx) * (px - qx) + (py - qy) * (py - qy) > far * far:
                        continue
                    fx, fy = px - 0.5 * (x0 + x1), py - 0.5 * (y0 + y1)
                    half = (0.5 * (x1 - x0), 0.5 * (y1 - y0), 0.0, 0.0)
                    apart = _apart(fx, fy, angle, shape[a], half)
                    clearance[a] = min(clearance[a], apart - shape[a, 2] - r)
                for j in range(len(position)):
                    if j == a or k < enters[j] or k > leaves[j] or (k == leaves[j] and s > 0):
                        continue
                    u, v, other = _pose(j, k, t, position, velocity, duration, last, heading, dt)
                    limit = max(clearance[a], gap[a, k]) if s == 0 else clearance[a]
                    far = max(radius[a] + radius[j] + limit, 0.0)
                    if (x - u) * (x - u) + (y - v) * (y - v) > far * far:
                        continue
                    c0, s0 = cos_sin(other)
                    half = (
                        shape[j, 0] * c0, shape[j, 0] * s0, -shape[j, 1] * s0, shape[j, 1] * c0
                    )  # fmt: skip
                    apart = _apart(x - u, y - v, angle, shape[a], half)
                    apart -= shape[a, 2] + shape[j, 2]
                    if counts:
                        clearance[a] = min(clearance[a], apart)
                    if s == 0:
                        gap[a, k] = min(gap[a, k], apart)


@kernel_without_allocation
def _pose(
    a: int, k: int, t: float, position: FloatArray, velocity: FloatArray, duration: FloatArray,
    last: IntArray, heading: FloatArray, dt: float,
) -> tuple[float, float, float]:  # fmt: skip
    """Return position and heading of agent a, t [s] after state k."""
    x, y, angle = position[a, k, 0], position[a, k, 1], heading[a, k]
    if t > 0.0 and k < last[a]:
        moved = min(t, duration[a, k])
        x += velocity[a, k, 0] * moved
        y += velocity[a, k, 1] * moved
        angle += wrap(heading[a, k + 1] - heading[a, k]) * (t / dt)
    return x, y, angle


@kernel_without_allocation
def _apart(
    fx: float, fy: float, angle: float, shape: FloatArray,
    other: tuple[float, float, float, float],
) -> float:  # fmt: skip
    """Return the distance [m] of a core at f and one of two half segments x, y, x, y."""
    c, s = cos_sin(angle)
    gx = (shape[0] * c, -shape[1] * s, other[0], other[2])
    gy = (shape[0] * s, shape[1] * c, other[1], other[3])
    distance: float = distance_to_sum(fx, fy, gx, gy)[2]
    return distance
