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


def nearest(p: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the point (…, 2) of the segment a–b that is nearest to p."""
    d = b - a
    length2 = (d * d).sum(axis=-1)
    share = ((p - a) * d).sum(axis=-1) / np.where(length2 > 0.0, length2, 1.0)
    near: FloatArray = a + np.clip(share, 0.0, 1.0)[..., None] * d
    return near


def first_touch(
    p: FloatArray, v: FloatArray, a: FloatArray, b: FloatArray, reach: FloatArray
) -> FloatArray:
    """Return when p + v t first comes within ``reach`` of the segment (…,); inf if never.

    It is the smallest of the times at which the point crosses the circles around both ends and the
    two lines beside the segment, as roots of polynomials.
    """
    offset = p - nearest(p, a, b)
    gap = np.hypot(offset[..., 0], offset[..., 1]) - reach
    approaching = (offset * v).sum(axis=-1) < -APPROACH * reach
    times = [_circle(p - end, v, reach) for end in (a, b)]
    times += [_line(p, v, a, b, reach, side) for side in (-1.0, 1.0)]
    first = np.where(gap <= TOUCHING, 0.0, np.min(times, axis=0))
    touch: FloatArray = np.where(approaching, first, math.inf)
    return touch


def _circle(f: FloatArray, v: FloatArray, reach: FloatArray) -> FloatArray:
    """Return the smallest t ≥ 0 with |f + v t| = reach."""
    a, b = (v * v).sum(axis=-1), 2.0 * (f * v).sum(axis=-1)
    under = b * b - 4.0 * a * ((f * f).sum(axis=-1) - reach * reach)
    hits = (a > 0.0) & (under >= 0.0)
    root = np.sqrt(np.where(hits, under, 0.0))
    both = [(-b + sign * root) / np.where(hits, 2.0 * a, 1.0) for sign in (-1.0, 1.0)]
    least: FloatArray = np.min([np.where(hits & (t >= 0.0), t, math.inf) for t in both], axis=0)
    return least


def _line(
    p: FloatArray, v: FloatArray, a: FloatArray, b: FloatArray, reach: FloatArray, side: float
) -> FloatArray:
    """Return t ≥ 0 at which p + v t lies beside the segment, at ``side`` · reach; inf if never."""
    d = b - a
    length = np.hypot(d[..., 0], d[..., 1])
    safe = np.where(length > 0.0, length, 1.0)
    normal = np.stack([-d[..., 1], d[..., 0]], axis=-1) / safe[..., None]
    speed = (v * normal).sum(axis=-1)
    moves = (length > 0.0) & (speed != 0.0)
    t = (side * reach - ((p - a) * normal).sum(axis=-1)) / np.where(moves, speed, 1.0)
    share = ((p + v * t[..., None] - a) * d).sum(axis=-1) / (safe * safe)
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
