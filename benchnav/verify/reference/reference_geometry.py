"""Touches and motion laws of the reference simulator: textbook formulas, numpy, no kernel.

Shapes: N agents, P capsules (a segment a–b with a radius), leading axes broadcast.
"""

import math
from collections.abc import Sequence

import numpy as np

from benchnav.arena.body import Body, LawKind
from benchnav.arrays import FloatArray

APPROACH = 1e-9  # a lower closing speed, over the reach, counts as zero
TOUCHING = 1e-12  # [m] a smaller gap is rounding


def dot(u: FloatArray, v: FloatArray) -> FloatArray:
    """Return the scalar products (…,) of vectors (…, 2)."""
    product: FloatArray = u[..., 0] * v[..., 0] + u[..., 1] * v[..., 1]
    return product


def unit(vector: FloatArray) -> FloatArray:
    """Return the vector (2,) with length 1; (1, 0) for zero."""
    length = math.hypot(*vector)
    return vector / length if length > 0.0 else np.array([1.0, 0.0])


def nearest(p: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the point (…, 2) of the segment a–b that is nearest to p."""
    d = b - a
    length2 = dot(d, d)
    share = dot(p - a, d) / np.where(length2 > 0.0, length2, 1.0)
    near: FloatArray = a + np.clip(share, 0.0, 1.0)[..., None] * d
    return near


def first_touch(
    p: FloatArray, v: FloatArray, a: FloatArray, b: FloatArray, reach: FloatArray
) -> FloatArray:
    """Return when p + v t first comes within ``reach`` of the segment (…,); inf if never.

    It is the smallest of the times at which the point crosses the circles around both ends and the
    two lines beside the segment, as roots of polynomials. A point that does not approach never
    touches: a segment is convex.
    """
    offset = p - nearest(p, a, b)
    gap = np.hypot(offset[..., 0], offset[..., 1]) - reach
    approaching = dot(offset, v) < -APPROACH * reach
    p, v, a, b = (np.broadcast_to(x, offset.shape)[approaching] for x in (p, v, a, b))
    reach, gap = np.broadcast_to(reach, approaching.shape)[approaching], gap[approaching]
    first = np.minimum(_circle(p - a, v, reach), _circle(p - b, v, reach))
    for side in (-1.0, 1.0):
        first = np.minimum(first, _line(p, v, a, b, reach, side))
    touch = np.full(approaching.shape, math.inf)
    touch[approaching] = np.where(gap <= TOUCHING, 0.0, first)
    return touch


def _circle(f: FloatArray, v: FloatArray, reach: FloatArray) -> FloatArray:
    """Return the smallest t ≥ 0 with |f + v t| = reach."""
    a, b = dot(v, v), 2.0 * dot(f, v)
    under = b * b - 4.0 * a * (dot(f, f) - reach * reach)
    hits = (a > 0.0) & (under >= 0.0)
    root = np.sqrt(np.where(hits, under, 0.0))
    both = [(-b + sign * root) / np.where(hits, 2.0 * a, 1.0) for sign in (-1.0, 1.0)]
    early, late = [np.where(hits & (t >= 0.0), t, math.inf) for t in both]
    least: FloatArray = np.minimum(early, late)
    return least


def _line(
    p: FloatArray, v: FloatArray, a: FloatArray, b: FloatArray, reach: FloatArray, side: float
) -> FloatArray:
    """Return t ≥ 0 at which p + v t lies beside the segment, at ``side`` · reach; inf if never."""
    d = b - a
    length = np.hypot(d[..., 0], d[..., 1])
    safe = np.where(length > 0.0, length, 1.0)
    normal = np.stack([-d[..., 1], d[..., 0]], axis=-1) / safe[..., None]
    speed = dot(v, normal)
    moves = (length > 0.0) & (speed != 0.0)
    t = (side * reach - dot(p - a, normal)) / np.where(moves, speed, 1.0)
    share = dot(p + v * t[..., None] - a, d) / (safe * safe)
    beside: FloatArray = np.where(moves & (t >= 0.0) & (share >= 0.0) & (share <= 1.0), t, math.inf)
    return beside


def law_position(body: Body, time: float, placed: bool) -> FloatArray:
    """Return the position (2,) [m] from a body's law at ``time`` [s]; ``placed``: relocated."""
    law = body.law
    if law.kind == LawKind.RELOCATE:
        there: FloatArray = law.points[-1 if placed else 0]
        return there
    if law.kind == LawKind.CIRCLE:
        angle = law.points[1, 1] + law.times[0] * time
        turned = np.array([math.cos(angle), math.sin(angle)])
        centre: FloatArray = law.points[0] + law.points[1, 0] * turned
        return centre
    t = time + law.phase
    if law.periodic and law.times[-1] > 0.0:
        t = t % law.times[-1]
    return np.array([np.interp(t, law.times, law.points[:, k]) for k in range(2)])


def inside(p: FloatArray, loops: Sequence[FloatArray]) -> bool:
    """Whether p (2,) is within the loops, by the even-odd rule."""
    crossings = 0
    for loop in loops:
        for a, b in zip(loop, np.roll(loop, -1, axis=0), strict=True):
            if (a[1] > p[1]) != (b[1] > p[1]):
                crossings += bool(p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
    return crossings % 2 == 1
