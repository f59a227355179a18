"""Footprints in the reference simulator: convex hulls of corner differences, no kernel.

A pose is (x, y, heading). Cores are arrays of corners (V, 2) about the centre.
"""

import math

import numpy as np

from benchnav.arena.agents import Agents
from benchnav.arrays import BoolArray, FloatArray
from benchnav.verify.reference.reference_geometry import dot, first_touch, nearest

APPROACH = 1e-9  # [m/s] a lower closing speed counts as zero


class Footprints:
    """The bodies of a world's agents: a core and the radius around it."""

    def __init__(self, agents: Agents) -> None:
        rounded = agents.rounding > 0.0
        self._half = np.stack([agents.half_length, agents.half_width], axis=1)
        self._half = np.where(rounded[:, None], self._half - agents.rounding[:, None], 0.0)
        self.rounding: FloatArray = np.where(rounded, agents.rounding, agents.radius)
        shaped: BoolArray = np.any(self._half > 0.0, axis=1)
        self.shaped = shaped  # (A,) False: a disc

    def reach(self, i: int) -> float:
        """Return the radius [m] of the circle around the core of agent i."""
        return math.hypot(*self._half[i])

    def core(self, i: int, heading: float) -> FloatArray:
        """Return the corners (V, 2) of agent i's core."""
        x, y = self._half[i]
        ahead = np.array([math.cos(heading), math.sin(heading)])
        left = np.array([-ahead[1], ahead[0]])
        return np.array([s * x * ahead + t * y * left for s in (-1, 1) for t in (-1, 1)])


def difference(core: FloatArray, other: FloatArray) -> FloatArray:
    """Return the convex hull (V, 2), counter-clockwise, of all differences other - core."""
    corners = (other[None] - core[:, None]).reshape(-1, 2)
    points = sorted({(float(x), float(y)) for x, y in corners})
    return np.array(_hull(points))


def _hull(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the hull of sorted points (Andrew's monotone chain)."""

    def half(ordered: list[tuple[float, float]]) -> list[tuple[float, float]]:
        chain: list[tuple[float, float]] = []
        for p in ordered:
            while len(chain) > 1 and _left_of(chain[-2], chain[-1], p) <= 0.0:
                chain.pop()
            chain.append(p)
        return chain[:-1]

    return half(points) + half(points[::-1]) if len(points) > 1 else points


def _left_of(a: tuple[float, float], b: tuple[float, float], p: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])


def away_from(p: FloatArray, hull: FloatArray) -> tuple[FloatArray, float]:
    """Return (unit vector away from the hull, distance [m]) of p; minus the depth inside."""
    ends = np.roll(hull, -1, axis=0)
    offset = p - nearest(p, hull, ends)
    distance = np.hypot(*offset.T)
    k = int(np.argmin(distance))
    edge = ends - hull
    length = np.hypot(*edge.T)
    if len(hull) > 2:
        outward = np.stack([edge[:, 1], -edge[:, 0]], axis=1) / length[:, None]
        beyond = dot(p - hull, outward)
        if (beyond <= 0.0).all():
            k = int(np.argmax(beyond))
            return outward[k], float(beyond[k])
    if distance[k] == 0.0:
        return np.array([1.0, 0.0]), 0.0
    return offset[k] / distance[k], float(distance[k])


def touch_time(p: FloatArray, v: FloatArray, hull: FloatArray, reach: float) -> float:
    """Return when p + v t first comes within ``reach`` of the hull; inf if never."""
    normal, distance = away_from(p, hull)
    if distance <= reach:
        return 0.0 if float(v @ normal) < -APPROACH else math.inf
    ends = np.roll(hull, -1, axis=0)
    return float(first_touch(p, v, hull, ends, np.full(len(hull), reach)).min())
