"""A guiding path: a leader's recorded trajectory, simplified, with what it was chosen for."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchnav.arrays import BoolArray, FloatArray
from benchnav.navigation.rehearsal import Rehearsal

STILL = 1e-3  # [m] a step that is shorter has no direction


@dataclass(frozen=True, eq=False)
class GuidingPath:
    """Where a leader went without a collision, fastest."""

    points: FloatArray  # (W, 2) [m], no two in succession equal
    duration: float  # [s] until the leader arrived
    turning: float  # [rad] that it turned in all
    radius: float  # [m] of the leader
    rehearsals: int  # out of which it was chosen
    succeeded: int  # of them without a collision

    @property
    def length(self) -> float:
        """[m]"""
        return float(self.arc[-1])

    @property
    def arc(self) -> FloatArray:
        """(W,) [m] length of the path up to each point."""
        return arc_length(self.points)


def best_path(
    rehearsals: Sequence[Rehearsal], agent: int, radius: float, tolerance: float, hits: bool = False
) -> GuidingPath | None:
    """The best trajectory of the leader ``agent``; None where it arrived in no rehearsal.

    The one that took the shortest time; of several, that which turns least; of several, the
    first. Only those without a collision, unless ``hits`` and there is none.

    Args:
        rehearsals: what the runner granted.
        agent: place of the leader among the agents of the briefing.
        radius: of the leader [m].
        tolerance: [m] by which the path may leave the trajectory.
        hits: take one with a collision where there is none without.
    """
    tries = [_Try(told, int(k)) for told in rehearsals for k in np.flatnonzero(told.agent == agent)]
    clean = [one for one in tries if one.arrived and not one.collided]
    chosen = clean or ([one for one in tries if one.arrived] if hits else [])
    if not chosen:
        return None
    best = min(chosen, key=lambda one: (one.duration, one.turning))
    points = distinct(simplified(best.way, tolerance))
    if len(points) < 2:
        return None
    return GuidingPath(points, best.duration, best.turning, radius, len(tries), len(clean))


class _Try:
    """One leader in one rehearsal."""

    def __init__(self, told: Rehearsal, leader: int) -> None:
        self.way = told.trajectory(leader)
        self.duration = float(told.arrival[leader])
        self.arrived = not math.isnan(self.duration)
        self.collided = bool(told.collided[leader])
        self.turning = turning(self.way)


def turning(way: FloatArray) -> float:
    """[rad] sum of the absolute changes of direction along ``way`` (N, 2)."""
    step = np.diff(way, axis=0)
    step = step[np.hypot(*step.T) > STILL]
    if len(step) < 2:
        return 0.0
    cross = step[:-1, 0] * step[1:, 1] - step[:-1, 1] * step[1:, 0]
    return float(np.abs(np.arctan2(cross, np.sum(step[:-1] * step[1:], axis=1))).sum())


def simplified(way: FloatArray, tolerance: float) -> FloatArray:
    """(W, 2) points of ``way`` (N, 2), none of which it leaves by more than ``tolerance`` [m].

    D. Douglas and T. Peucker, "Algorithms for the reduction of the number of points
    required to represent a digitized line or its caricature", Cartographica 10 (1973).
    """
    kept: BoolArray = np.zeros(len(way), np.bool_)
    kept[[0, -1]] = True
    open_ = [(0, len(way) - 1)]
    while open_:
        first, last = open_.pop()
        if last - first < 2:
            continue
        away = _distances(way[first + 1 : last], way[first], way[last])
        farthest = int(np.argmax(away))
        if away[farthest] > tolerance:
            middle = first + 1 + farthest
            kept[middle] = True
            open_ += [(first, middle), (middle, last)]
    return way[kept].copy()


def _distances(points: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """(N,) [m] from points (N, 2) to the segment from start to end."""
    along = end - start
    length2 = float(along @ along)
    share = np.clip((points - start) @ along / length2, 0.0, 1.0) if length2 else np.zeros(1)
    offset = points - start - np.multiply.outer(share, along)
    distance: FloatArray = np.sqrt(np.sum(offset * offset, axis=1))
    return distance


def distinct(points: FloatArray) -> FloatArray:
    """The points without those that repeat the one before."""
    new = np.ones(len(points), np.bool_)
    new[1:] = np.any(points[1:] != points[:-1], axis=1)
    return points[new]


def arc_length(points: FloatArray) -> FloatArray:
    """(W,) [m] length of the way up to each point (W, 2)."""
    step = np.diff(points, axis=0)
    return np.concatenate([[0.0], np.cumsum(np.sqrt(np.sum(step * step, axis=1)))])
