"""Swept tests in the obvious way: the nearest of many points, and a ray that counts edges."""

import math

import numpy as np

from benchnav.arena.solid import Solid
from benchnav.arrays import FloatArray


def point_segment_distance(p: FloatArray, a: FloatArray, b: FloatArray) -> float:
    d = b - a
    length2 = float(d @ d)
    t = 0.0 if length2 == 0.0 else min(1.0, max(0.0, float(d @ (p - a)) / length2))
    return math.hypot(*(p - a - t * d))


def segment_distance(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> float:
    """Distance to a segment is convex along another, so a ternary search finds the least."""
    low, high = 0.0, 1.0
    for _ in range(200):
        s, t = low + (high - low) / 3.0, high - (high - low) / 3.0
        if point_segment_distance(a + s * (b - a), c, d) < point_segment_distance(
            a + t * (b - a), c, d
        ):
            high = t
        else:
            low = s
    return point_segment_distance(a + 0.5 * (low + high) * (b - a), c, d)


def motion_is_free(p: FloatArray, q: FloatArray, radius: float, capsules: FloatArray) -> bool:
    return all(segment_distance(p, q, c[:2], c[2:4]) >= radius + c[4] for c in capsules)


def inside_polygon(p: FloatArray, loop: FloatArray) -> float:
    """Winding number of a loop about p, by summing angles."""
    angle = np.unwrap(np.arctan2(*(np.vstack([loop, loop[:1]]) - p).T[::-1]))
    return float(angle[-1] - angle[0]) / (2.0 * math.pi)


def inside_solid(p: FloatArray, solid: Solid) -> bool:
    """Solid to the left: a box far larger than the solid tells which side infinity is on."""
    if solid.is_disc:
        return math.hypot(*(p - np.array(solid.center))) < solid.radius
    area = sum(
        float(a[0] * b[1] - a[1] * b[0])
        for loop in solid.loops
        for a, b in zip(loop, np.roll(loop, -1, axis=0), strict=True)
    )
    turns = round(sum(inside_polygon(p, loop) for loop in solid.loops))
    return turns + (area < -1e-9) > 0
