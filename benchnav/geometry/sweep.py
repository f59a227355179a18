"""The exact collision test of a disc that moves along a segment among capsules.

The motion is not sampled: it is free from p to q if the distance between the segment pq and
each capsule's axis is at least the sum of the two radii, and pq does not cross the axis.
Touching is free: the disc is open. A motion that lies completely inside a solid touches no edge,
so use `inside_solid` as well for the points where motions begin.

Kernels use correctly rounded operations only. `Capsules` arrays are (P, 5)
x0, y0, x1, y1, radius [m].
"""

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.geometry.capsule import nearest_on_segment, segments_cross
from benchnav.kernels import kernel, kernel_without_allocation


@kernel_without_allocation
def point_segment_distance2(
    px: float, py: float, x0: float, y0: float, x1: float, y1: float
) -> float:
    """Return the squared distance [m²] of a point and a segment."""
    qx, qy = nearest_on_segment(px, py, x0, y0, x1, y1)
    return (px - qx) * (px - qx) + (py - qy) * (py - qy)


@kernel_without_allocation
def segment_distance2(
    ax: float, ay: float, bx: float, by: float, x0: float, y0: float, x1: float, y1: float
) -> float:
    """Return the squared distance [m²] of two segments: 0 if they cross, else of an end point."""
    if segments_cross(ax, ay, bx, by, x0, y0, x1, y1):
        return 0.0
    d = point_segment_distance2(ax, ay, x0, y0, x1, y1)
    d = min(d, point_segment_distance2(bx, by, x0, y0, x1, y1))
    d = min(d, point_segment_distance2(x0, y0, ax, ay, bx, by))
    least: float = min(d, point_segment_distance2(x1, y1, ax, ay, bx, by))
    return least


@kernel
def segment_capsule_distance(
    ax: float, ay: float, bx: float, by: float, capsule: FloatArray
) -> float:
    """Return the distance [m] of the segment ab and a capsule (5,); negative if they overlap."""
    d2 = segment_distance2(ax, ay, bx, by, capsule[0], capsule[1], capsule[2], capsule[3])
    distance: float = math.sqrt(d2) - capsule[4]
    return distance


@kernel
def is_free_of(
    px: float, py: float, qx: float, qy: float, radius: float, capsule: FloatArray
) -> bool:
    """Whether a disc can move from p to q without entering one capsule (5,)."""
    x0, y0, x1, y1 = capsule[0], capsule[1], capsule[2], capsule[3]
    reach = radius + capsule[4]
    if max(px, qx) + reach < min(x0, x1) or max(x0, x1) + reach < min(px, qx):
        return True
    if max(py, qy) + reach < min(y0, y1) or max(y0, y1) + reach < min(py, qy):
        return True
    if segments_cross(px, py, qx, qy, x0, y0, x1, y1):
        return False
    free: bool = segment_distance2(px, py, qx, qy, x0, y0, x1, y1) >= reach * reach
    return free


@kernel
def motion_is_free(
    px: float, py: float, qx: float, qy: float, radius: float, capsules: FloatArray
) -> bool:
    """Whether a disc of ``radius`` [m] can move straight from p to q among capsules (P, 5)."""
    free = True
    for i in range(capsules.shape[0]):
        free = is_free_of(px, py, qx, qy, radius, capsules[i])
        if not free:
            break
    return free


@kernel
def clearance(px: float, py: float, capsules: FloatArray) -> float:
    """Return the distance [m] to the nearest capsule (P, 5); negative inside one, inf if none."""
    least = math.inf
    for i in range(capsules.shape[0]):
        x0, y0, x1, y1, r = capsules[i]
        least = min(least, math.sqrt(point_segment_distance2(px, py, x0, y0, x1, y1)) - r)
    return least


@kernel
def inside_solid(
    px: float, py: float, capsules: FloatArray, first: IntArray, outside: IntArray
) -> bool:
    """Whether a point lies within the loops of any solid.

    Solid s owns the capsules first[s]:first[s + 1]; ``outside`` (S,) is its winding
    number far away (`solid_index`). Solids are tested one by one, so that they may
    overlap. Discs are covered by the distance tests.
    """
    for s in range(first.shape[0] - 1):
        turns = outside[s]
        for i in range(first[s], first[s + 1]):
            turns += winding(px, py, capsules[i, 0], capsules[i, 1], capsules[i, 2], capsules[i, 3])
        if turns > 0:
            return True
    return False


@kernel_without_allocation
def winding(px: float, py: float, x0: float, y0: float, x1: float, y1: float) -> int:
    """Return 1, -1 or 0: what an edge adds to the winding number around a point."""
    if (y0 <= py) == (y1 <= py):
        return 0
    left = (x1 - x0) * (py - y0) - (px - x0) * (y1 - y0)
    if y0 <= py:
        return 1 if left > 0.0 else 0
    return -1 if left < 0.0 else 0


class Outlined(Protocol):
    """The attributes of a solid that this module needs (`benchnav.arena.solid.Solid`)."""

    @property
    def loops(self) -> tuple[FloatArray, ...]: ...
    @property
    def capsules(self) -> FloatArray: ...
    @property
    def is_disc(self) -> bool: ...


def solid_index(solids: Sequence[Outlined]) -> tuple[IntArray, IntArray]:
    """Return (first (S+1,), outside (S,)) for `inside_solid`.

    ``outside`` is 1 if the solid extends to infinity: the inside of a walled arena
    is a clockwise loop, so the loops of such a solid enclose a negative area.
    """
    first = np.zeros(len(solids) + 1, np.int64)
    outside = np.zeros(len(solids), np.int64)
    for s, solid in enumerate(solids):
        first[s + 1] = first[s] + len(solid.capsules)
        outside[s] = 0 if solid.is_disc else int(_reaches_to_infinity(solid))
    return first, outside


def _reaches_to_infinity(solid: Outlined) -> bool:
    """Whether the loops enclose a negative area, beyond the rounding errors of thin walls."""
    loops = [loop for loop in solid.loops if len(loop) > 2]  # two vertices enclose nothing
    if not loops:
        return False
    extent = float(np.ptp(np.vstack(loops), axis=0).max())
    return sum(map(_area, loops)) < -1e-12 * extent * extent


def _area(loop: FloatArray) -> float:
    """Return the signed area [m²] of a loop (V, 2), computed about its first vertex."""
    x, y = (loop - loop[0]).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
