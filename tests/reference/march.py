"""Slow, obvious twins of the kernels of the guided crowd: they look at many points."""

import numpy as np


def sampled(way, step=1e-3):
    """(N, 2), (N,) points of a polyline and their arc lengths, ``step`` apart."""
    length = np.hypot(*np.diff(way, axis=0).T)
    arc = np.concatenate([[0.0], np.cumsum(length)])
    s = np.arange(0.0, arc[-1] + step, step).clip(max=arc[-1])
    return np.stack([np.interp(s, arc, way[:, k]) for k in (0, 1)], axis=1), s


def advanced(way, low, high, place):
    """Arc length in [low, high] whose point is nearest."""
    points, s = sampled(way)
    within = (s >= low) & (s <= high)
    away = np.hypot(*(points[within] - place).T)
    return s[within][np.argmin(away)]


def touches(edges, a, b, radius, step=1e-3):
    """The edges (E, 2, 2) that a disc touches on its way from a to b, and those it touches at a."""
    share = np.linspace(0.0, 1.0, max(2, int(np.hypot(*(b - a)) / step)))[:, None]
    way = a + share * (b - a)
    away = np.array([_distance(way, *edge) for edge in edges])
    return away.min(axis=1) < radius, away[:, 0] <= radius, away.min(axis=1) < away[:, 0] - 1e-3


def _distance(points, start, end):
    along = end - start
    share = np.clip((points - start) @ along / (along @ along), 0.0, 1.0)
    return np.hypot(*(points - start - share[:, None] * along).T)
