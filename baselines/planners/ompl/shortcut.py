"""Shorten a path within free space, without random numbers."""

import math
from itertools import pairwise

import numpy as np

from benchnav.arrays import FloatArray

from ...common.validity_checker import Checker

_Point = tuple[float, float]
_ROUNDS = 20
_PULLS = 2  # in each round
_HALVINGS = 6
_SHARP = math.cos(math.radians(20.0))  # corners that turn by less are not cut off
_GAIN = 1e-3  # a round that shortens by less than this share is the last


def shortened(path: FloatArray, checker: Checker) -> FloatArray:
    """Return a path (W', 2) between the same ends that is no longer than ``path`` (W, 2).

    It skips waypoints if a straight motion is free, then makes the path taut: corners
    are cut off as far as possible, and waypoints are pulled towards the line between
    their neighbours, while that shortens the path.
    """
    points = _skipped([(float(x), float(y)) for x, y in path], checker, len(path))
    length = _length(points)
    for _ in range(_ROUNDS):
        points = _cut(points, checker)
        for _ in range(_PULLS):
            points = _pulled(points, checker)
        points = _skipped(points, checker, 8)
        before, length = length, _length(points)
        if length > before * (1.0 - _GAIN):
            break
    return np.array(points)


def _skipped(points: list[_Point], checker: Checker, most: int) -> list[_Point]:
    """Go from each waypoint straight to the farthest of the next ``most`` reachable ones."""
    kept, here, last = points[:1], 0, len(points) - 1
    while here < last:
        there = min(last, here + most)
        while there > here + 1 and not checker.motion_is_free(*points[here], *points[there]):
            there -= 1
        kept.append(points[there])
        here = there
    return kept


def _cut(points: list[_Point], checker: Checker) -> list[_Point]:
    """Replace each sharp corner by the largest free chamfer of ½, ¼, … of its sides."""
    result = points[:1]
    for corner, after in pairwise(points[1:]):
        before, share = result[-1], 1.0
        if _straightness(before, corner, after) < _SHARP:
            for _ in range(_HALVINGS):
                share *= 0.5
                a, b = _between(corner, before, share), _between(corner, after, share)
                if checker.motion_is_free(*a, *b):
                    result += [a, b]
                    break
            else:
                result.append(corner)
        else:
            result.append(corner)
    return [*result, points[-1]]


def _pulled(points: list[_Point], checker: Checker) -> list[_Point]:
    """Move each inner waypoint towards the line between its neighbours, as far as it is free."""
    result = points[:1]
    for point, after in pairwise(points[1:]):
        before, share = result[-1], 1.0
        target = _foot(point, before, after)
        for _ in range(_HALVINGS):
            moved = _between(point, target, share)
            if checker.motion_is_free(*before, *moved) and checker.motion_is_free(*moved, *after):
                point = moved
                break
            share *= 0.5
        result.append(point)
    return [*result, points[-1]]


def _between(a: _Point, b: _Point, share: float) -> _Point:
    return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])


def _foot(p: _Point, a: _Point, b: _Point) -> _Point:
    """Return the point of the segment ab that is nearest to p."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    length2 = dx * dx + dy * dy
    along = (p[0] - a[0]) * dx + (p[1] - a[1]) * dy
    return _between(a, b, min(max(along / length2, 0.0), 1.0)) if length2 > 0.0 else a


def _straightness(a: _Point, b: _Point, c: _Point) -> float:
    """Return the cosine of the turn at b; 1 if there is none."""
    ux, uy, vx, vy = b[0] - a[0], b[1] - a[1], c[0] - b[0], c[1] - b[1]
    scale = math.hypot(ux, uy) * math.hypot(vx, vy)
    return (ux * vx + uy * vy) / scale if scale > 0.0 else 1.0


def _length(points: list[_Point]) -> float:
    return sum(math.dist(a, b) for a, b in pairwise(points))
