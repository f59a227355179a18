"""Distances from shapes to solids: the one test for all placement."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from benchnav.arena.solid import Kind, Solid
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.geometry.capsule import nearest_on_segment, segments_cross
from benchnav.kernels import kernel

POINT = np.zeros((1, 5))  # a shape
_FILLED = np.zeros(1, np.bool_)  # an obstacle is not hollow


class Barrier(NamedTuple):
    """Solids as arrays for kernels."""

    capsules: FloatArray  # (P, 5) x0, y0, x1, y1, radius
    first: IntArray  # (S+1,) capsules of solid s are first[s]:first[s+1]
    hollow: BoolArray  # (S,) True if the solid is the outside of its loops


def barrier(solids: Sequence[Solid]) -> Barrier:
    """Return the solids as one barrier."""
    parts = [solid.capsules for solid in solids]
    first = np.zeros(len(parts) + 1, np.int64)
    np.cumsum([len(p) for p in parts], out=first[1:])
    capsules = np.ascontiguousarray(np.vstack([np.zeros((0, 5)), *parts]))
    return Barrier(capsules, first, np.array([_hollow(solid) for solid in solids], np.bool_))


def _hollow(solid: Solid) -> bool:
    if solid.kind != Kind.WALL or solid.is_disc:
        return False  # an obstacle is never the outside of its loops
    c = solid.capsules
    return float(np.dot(c[:, 0], c[:, 3]) - np.dot(c[:, 2], c[:, 1])) < 0.0


def joined(one: Barrier, other: Barrier) -> Barrier:
    """Return both barriers as one."""
    if not len(one.hollow) or not len(other.hollow):
        return one if len(one.hollow) else other
    return Barrier(
        np.vstack([one.capsules, other.capsules]),
        np.concatenate([one.first, one.first[-1] + other.first[1:]]),
        np.concatenate([one.hollow, other.hollow]),
    )


def added(one: Barrier, capsules: FloatArray) -> Barrier:
    """Return the barrier with one more obstacle (P, 5)."""
    return Barrier(
        np.concatenate((one.capsules, capsules)),
        np.concatenate((one.first, one.first[-1:] + len(capsules))),
        np.concatenate((one.hollow, _FILLED)),
    )


def clear(
    shape: FloatArray, points: FloatArray, wall: Barrier, gap: float, whole: bool = True
) -> BoolArray:
    """Whether a shape is farther than ``gap`` [m] ≥ 0 from every solid at each point, (N,).

    Args:
        shape: (Q, 5) about the origin: one capsule, or the edges of loops, counter-clockwise
            around it.
        points: (N, 2) [m] the places of its origin.
        wall: the solids.
        gap: [m].
        whole: False if the capsules are separate, as those of a path are: they enclose nothing.
    """
    free: BoolArray = _clear(
        shape, np.ascontiguousarray(points), wall.capsules, wall.first, wall.hollow, gap, whole
    )
    return free


@kernel
def _clear(
    shape: FloatArray, points: FloatArray, capsules: FloatArray, first: IntArray,
    hollow: BoolArray, gap: float, whole: bool,
) -> BoolArray:  # fmt: skip
    result = np.ones(len(points), np.bool_)
    size = len(shape) if whole else 1
    moved = shape.copy()
    for n in range(len(points)):
        x, y = points[n, 0], points[n, 1]
        for q in range(len(shape)):
            moved[q, 0], moved[q, 1] = shape[q, 0] + x, shape[q, 1] + y
            moved[q, 2], moved[q, 3] = shape[q, 2] + x, shape[q, 3] + y
        for low in range(0, len(shape), size):
            part = moved[low : low + size]
            if not _apart(part, capsules, gap) or _nested(part, capsules, first, hollow):
                result[n] = False
                break
    return result


@kernel
def _apart(shape: FloatArray, capsules: FloatArray, gap: float) -> bool:
    """Whether no capsule of the shape (Q, 5) is within ``gap`` of any other."""
    for p in range(len(capsules)):
        for q in range(len(shape)):
            if _near(shape[q], capsules[p], gap):
                return False
    return True


@kernel
def _nested(shape: FloatArray, capsules: FloatArray, first: IntArray, hollow: BoolArray) -> bool:
    """Whether one contains part of the other; for separate edges, one point per loop decides."""
    for s in range(len(hollow)):
        edges = capsules[first[s] : first[s + 1]]
        if _holds(edges, shape, 1 if hollow[s] else 0):
            return True
        if len(shape) > 2 and _holds(shape, edges, 0):
            return True
    return False


@kernel
def _holds(loops: FloatArray, other: FloatArray, around: int) -> bool:
    """Whether a loop of ``other`` begins inside ``loops`` (P, 5); ``around``: winding outside."""
    for q in range(len(other)):
        x, y = other[q, 0], other[q, 1]
        goes_on = q > 0 and x == other[q - 1, 2] and y == other[q - 1, 3]
        if not goes_on and _winding(x, y, loops) + around > 0:
            return True
    return False


@kernel
def _near(a: FloatArray, b: FloatArray, gap: float) -> bool:
    """Whether two capsules (5,) are within ``gap`` of each other."""
    reach = a[4] + b[4] + gap
    if (
        max(a[0], a[2]) + reach < min(b[0], b[2])
        or max(b[0], b[2]) + reach < min(a[0], a[2])
        or max(a[1], a[3]) + reach < min(b[1], b[3])
        or max(b[1], b[3]) + reach < min(a[1], a[3])
    ):
        return False
    if segments_cross(a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]):
        return True
    least = min(
        min(_distance2(a[0], a[1], b), _distance2(a[2], a[3], b)),
        min(_distance2(b[0], b[1], a), _distance2(b[2], b[3], a)),
    )
    near: bool = least <= reach * reach
    return near


@kernel
def _distance2(x: float, y: float, c: FloatArray) -> float:
    nx, ny = nearest_on_segment(x, y, c[0], c[1], c[2], c[3])
    squared: float = (x - nx) * (x - nx) + (y - ny) * (y - ny)
    return squared


@kernel
def _winding(x: float, y: float, edges: FloatArray) -> int:
    """Return the winding number of the loops (P, 5) about (x, y), counter-clockwise positive."""
    turns = 0
    for p in range(len(edges)):
        x0, y0, x1, y1 = edges[p, 0], edges[p, 1], edges[p, 2], edges[p, 3]
        side = (x1 - x0) * (y - y0) - (x - x0) * (y1 - y0)
        if y0 <= y < y1 and side > 0.0:
            turns += 1
        elif y1 <= y < y0 and side < 0.0:
            turns -= 1
    return turns
