"""Distances of footprints by convex hulls: obvious and slow."""

import math
from itertools import product

import numpy as np


def sum_hull(gx, gy):
    """Return the corners (V, 2) of all signed sums of half segments, counter-clockwise."""
    signs = product((-1.0, 1.0), repeat=len(gx))
    points = {
        (
            sum(s * g for s, g in zip(sign, gx, strict=False)),
            sum(s * g for s, g in zip(sign, gy, strict=False)),
        )
        for sign in signs
    }
    return np.array(_hull(sorted(points)))


def _hull(points):
    """Andrew's monotone chain."""

    def half(ordered):
        chain = []
        for p in ordered:
            while len(chain) > 1 and _left(chain[-2], chain[-1], p) <= 0.0:
                chain.pop()
            chain.append(p)
        return chain[:-1]

    return half(points) + half(points[::-1]) if len(points) > 1 else points


def _left(a, b, p):
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])


def hull_distance(x, y, hull):
    """Return the distance of a point and a convex polygon; minus the depth inside."""
    if len(hull) == 1:
        return math.hypot(x - hull[0][0], y - hull[0][1])
    nexts = np.roll(hull, -1, axis=0)
    span = nexts - hull
    length = np.hypot(*span.T)
    left = (span[:, 0] * (y - hull[:, 1]) - span[:, 1] * (x - hull[:, 0])) / length
    if len(hull) > 2 and (left > 0.0).all():
        return -float(left.min())
    along = ((np.array([x, y]) - hull) * span).sum(1) / length**2
    foot = hull + np.clip(along, 0.0, 1.0)[:, None] * span
    return float(np.hypot(*(np.array([x, y]) - foot).T).min())
