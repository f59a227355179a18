"""Distances from shapes to solids: the one test for all placement."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from benchnav.arena.solid import Kind, Solid, is_outside
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.geometry.capsule import nearest_on_segment, segments_cross
from benchnav.kernels import kernel, kernel_without_allocation

POINT = np.zeros((1, 5))  # a shape
_FILLED = np.zeros(1, np.bool_)  # an obstacle is not hollow
_FEW_TESTS = 16  # for which sorting the capsules into bands costs more than it saves
_FEW_CAPSULES = 64


class Barrier(NamedTuple):
    """Solids as arrays for kernels."""

    capsules: FloatArray  # (P, 5) x0, y0, x1, y1, radius
    first: IntArray  # (S+1,) capsules of solid s are first[s]:first[s+1]
    hollow: BoolArray  # (S,) True if the solid is the outside of its loops


class _Bands(NamedTuple):
    """The capsules of a barrier that reach each horizontal band, ascending within a band."""

    low: float  # [m] least y of the first band
    height: float  # [m] of a band
    start: IntArray  # (bands + 1,) first item of each band
    item: IntArray  # capsule indices by band
    owner: IntArray  # (P,) solid of each capsule
    first: IntArray  # (S+1,)
    hollow: BoolArray  # (S,)
    hollows: int


def barrier(solids: Sequence[Solid]) -> Barrier:
    """Return the solids as one barrier."""
    parts = [solid.capsules for solid in solids]
    first = np.zeros(len(parts) + 1, np.int64)
    np.cumsum([len(p) for p in parts], out=first[1:])
    capsules = np.ascontiguousarray(np.vstack([np.zeros((0, 5)), *parts]))
    return Barrier(capsules, first, np.array([_hollow(solid) for solid in solids], np.bool_))


def _hollow(solid: Solid) -> bool:
    return solid.kind == Kind.WALL and is_outside(solid)  # an obstacle is never the outside


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


def first_clear(
    shape: FloatArray, points: FloatArray, wall: Barrier, gap: float, whole: bool = True
) -> int:
    """Return the index of the first point at which `clear` is true; -1 if there is none."""
    found: int = _first_clear(shape, points, wall.capsules, wall.first, wall.hollow, gap, whole)
    return found


@kernel
def _clear(
    shape: FloatArray, points: FloatArray, capsules: FloatArray, first: IntArray,
    hollow: BoolArray, gap: float, whole: bool,
) -> BoolArray:  # fmt: skip
    size = len(shape) if whole else 1
    many = len(points) * (len(shape) // size) > _FEW_TESTS
    bands, moved = _bands(capsules, first, hollow, many), shape.copy()
    result = np.empty(len(points), np.bool_)
    for n in range(len(points)):
        result[n] = _is_clear(shape, points[n], size, moved, capsules, bands, gap)
    return result


@kernel
def _first_clear(
    shape: FloatArray, points: FloatArray, capsules: FloatArray, first: IntArray,
    hollow: BoolArray, gap: float, whole: bool,
) -> int:  # fmt: skip
    size = len(shape) if whole else 1
    many = len(points) * (len(shape) // size) > _FEW_TESTS
    bands, moved = _bands(capsules, first, hollow, many), shape.copy()
    for n in range(len(points)):
        if _is_clear(shape, points[n], size, moved, capsules, bands, gap):
            return n
    return -1


@kernel_without_allocation
def _is_clear(
    shape: FloatArray, point: FloatArray, size: int, moved: FloatArray, capsules: FloatArray,
    bands: _Bands, gap: float,
) -> bool:  # fmt: skip
    """Whether every part of ``size`` capsules is clear at ``point``; ``moved`` is scratch."""
    x, y = point[0], point[1]
    for q in range(len(shape)):
        moved[q, 0], moved[q, 1] = shape[q, 0] + x, shape[q, 1] + y
        moved[q, 2], moved[q, 3] = shape[q, 2] + x, shape[q, 3] + y
    for low in range(0, len(shape), size):
        part = moved[low : low + size]
        if not _apart(part, capsules, bands, gap) or _nested(part, capsules, bands):
            return False
    return True


@kernel
def _bands(capsules: FloatArray, first: IntArray, hollow: BoolArray, many: bool) -> _Bands:
    """List the capsules by the horizontal bands that they reach; one band if few are tested."""
    owner = np.empty(len(capsules), np.int64)
    for s in range(len(hollow)):
        owner[first[s] : first[s + 1]] = s
    size = len(capsules)
    if not many or size < _FEW_CAPSULES:
        whole = np.array([0, size])
        return _Bands(0.0, 1.0, whole, np.arange(size), owner, first, hollow, hollow.sum())
    low, high, tall = math.inf, -math.inf, 0.0
    for p in range(size):
        bottom, top = _span(capsules[p])
        low, high, tall = min(low, bottom), max(high, top), tall + (top - bottom)
    # about the root of the number of capsules, but not so many that a capsule reaches many
    height = max((high - low) / math.sqrt(size), tall / size, 1e-9)
    start = np.zeros(int((high - low) / height) + 2, np.int64)
    for p in range(size):
        bottom, top = _span(capsules[p])
        for k in range(int((bottom - low) / height), int((top - low) / height) + 1):
            start[k + 1] += 1
    start = np.cumsum(start)
    free, item = start.copy(), np.empty(start[-1], np.int64)
    for p in range(size):
        bottom, top = _span(capsules[p])
        for k in range(int((bottom - low) / height), int((top - low) / height) + 1):
            item[free[k]] = p
            free[k] += 1
    return _Bands(low, height, start, item, owner, first, hollow, hollow.sum())


@kernel_without_allocation
def _span(capsule: FloatArray) -> tuple[float, float]:
    """Return the least and the greatest y of a capsule (5,)."""
    y0, y1, radius = capsule[1], capsule[3], capsule[4]
    return min(y0, y1) - radius, max(y0, y1) + radius


@kernel_without_allocation
def _reached(bands: _Bands, low: float, high: float) -> tuple[int, int]:
    """Return the items of all bands from ``low`` to ``high`` [m], as a range."""
    last = len(bands.start) - 2
    if last == 0:
        return bands.start[0], bands.start[1]
    k0, k1 = (low - bands.low) / bands.height, (high - bands.low) / bands.height
    if k1 < 0.0 or k0 >= last + 1:
        return 0, 0
    return bands.start[int(max(k0, 0.0))], bands.start[int(min(k1, last)) + 1]


@kernel_without_allocation
def _apart(shape: FloatArray, capsules: FloatArray, bands: _Bands, gap: float) -> bool:
    """Whether no capsule of the shape (Q, 5) is within ``gap`` of any other."""
    for q in range(len(shape)):
        low, high = _span(shape[q])
        begin, end = _reached(bands, low - gap, high + gap)
        for k in range(begin, end):
            if _near(shape[q], capsules[bands.item[k]], gap):
                return False
    return True


@kernel_without_allocation
def _nested(shape: FloatArray, capsules: FloatArray, bands: _Bands) -> bool:
    """Whether one contains part of the other; for separate edges, one point per loop decides."""
    for q in range(len(shape)):
        x, y = shape[q, 0], shape[q, 1]
        goes_on = q > 0 and x == shape[q - 1, 2] and y == shape[q - 1, 3]
        if not goes_on and _inside_any(x, y, capsules, bands):
            return True
    return len(shape) > 2 and _holds_any(shape, capsules, bands)


@kernel_without_allocation
def _inside_any(x: float, y: float, capsules: FloatArray, bands: _Bands) -> bool:
    """Whether a point is inside a solid: outside the loops of one that is hollow."""
    begin, end = _reached(bands, y, y)
    beside = bands.hollows
    k = begin
    while k < end:
        s, turns = bands.owner[bands.item[k]], 0
        while k < end and bands.owner[bands.item[k]] == s:
            turns += _turn(x, y, capsules[bands.item[k]])
            k += 1
        if turns + bands.hollow[s] > 0:
            return True
        beside -= bands.hollow[s]
    return beside > 0  # no edge of a hollow solid is in this band


@kernel_without_allocation
def _holds_any(shape: FloatArray, capsules: FloatArray, bands: _Bands) -> bool:
    """Whether a loop of a solid begins inside the shape (Q, 5)."""
    low, high = math.inf, -math.inf
    for q in range(len(shape)):
        low, high = min(low, shape[q, 1]), max(high, shape[q, 1])
    begin, end = _reached(bands, low, high)
    for k in range(begin, end):
        p = bands.item[k]
        x, y = capsules[p, 0], capsules[p, 1]
        begins = p == bands.first[bands.owner[p]]
        if not begins:
            begins = x != capsules[p - 1, 2] or y != capsules[p - 1, 3]
        if begins and _winding(x, y, shape) > 0:
            return True
    return False


@kernel_without_allocation
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


@kernel_without_allocation
def _distance2(x: float, y: float, c: FloatArray) -> float:
    nx, ny = nearest_on_segment(x, y, c[0], c[1], c[2], c[3])
    squared: float = (x - nx) * (x - nx) + (y - ny) * (y - ny)
    return squared


@kernel_without_allocation
def _winding(x: float, y: float, edges: FloatArray) -> int:
    """Return the winding number of the loops (P, 5) about (x, y), counter-clockwise positive."""
    turns = 0
    for p in range(len(edges)):
        turns += _turn(x, y, edges[p])
    return turns


@kernel_without_allocation
def _turn(x: float, y: float, edge: FloatArray) -> int:
    """Return what an edge (5,) adds to the winding number about (x, y)."""
    x0, y0, x1, y1 = edge[0], edge[1], edge[2], edge[3]
    side = (x1 - x0) * (y - y0) - (x - x0) * (y1 - y0)
    if y0 <= y < y1 and side > 0.0:
        return 1
    if y1 <= y < y0 and side < 0.0:
        return -1
    return 0
