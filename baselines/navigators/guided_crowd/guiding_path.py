"""A guiding path: a leader's recorded trajectory, simplified, with the data of its selection."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchnav.arrays import BoolArray, FloatArray
from benchnav.navigation import Rehearsal

STILL = 1e-3  # [m] a shorter step has no direction


@dataclass(frozen=True, eq=False)
class GuidingPath:
    """The fastest trajectory of a leader without a collision."""

    points: FloatArray  # (W, 2) [m], no two in succession equal
    duration: float  # [s] until the leader arrived
    turning: float  # [rad] total change of direction
    radius: float  # [m] of the leader
    rehearsals: int  # among which it was chosen
    succeeded: int  # rehearsals without a collision

    @property
    def length(self) -> float:
        """Length of the path [m]."""
        return float(self.arc[-1])

    @property
    def arc(self) -> FloatArray:
        """Length (W,) [m] of the path up to each point."""
        return arc_length(self.points)


def best_path(
    rehearsals: Sequence[Rehearsal], agent: int, radius: float, tolerance: float, hits: bool = False
) -> GuidingPath | None:
    """Return the best trajectory of the leader ``agent``; None if it arrived in no rehearsal.

    It is the fastest one; of several, the one that turns least; of several, the
    first. Only trajectories without a collision count, unless ``hits`` is set and there is none.

    Args:
        rehearsals: granted by the runner.
        agent: index of the leader among the agents of the briefing.
        radius: of the leader [m].
        tolerance: largest distance [m] of the path from the trajectory.
        hits: accept a trajectory with a collision if there is none without.
    """
    tries = [_Try(r, int(k)) for r in rehearsals for k in np.flatnonzero(r.agent == agent)]
    clean = [t for t in tries if t.arrived and not t.collided]
    chosen = clean or ([t for t in tries if t.arrived] if hits else [])
    if not chosen:
        return None
    best = min(chosen, key=lambda t: (t.duration, t.turning))
    points = distinct(simplified(best.way, tolerance))
    if len(points) < 2:
        return None
    return GuidingPath(points, best.duration, best.turning, radius, len(tries), len(clean))


class _Try:
    """One leader in one rehearsal."""

    def __init__(self, rehearsal: Rehearsal, leader: int) -> None:
        self.way = rehearsal.trajectory(leader)
        self.duration = float(rehearsal.arrival[leader])
        self.arrived = not math.isnan(self.duration)
        self.collided = bool(rehearsal.collided[leader])
        self.turning = turning(self.way)


def turning(way: FloatArray) -> float:
    """Return the sum [rad] of the absolute changes of direction along ``way`` (N, 2)."""
    step = np.diff(way, axis=0)
    step = step[np.hypot(*step.T) > STILL]
    if len(step) < 2:
        return 0.0
    cross = step[:-1, 0] * step[1:, 1] - step[:-1, 1] * step[1:, 0]
    return float(np.abs(np.arctan2(cross, np.sum(step[:-1] * step[1:], axis=1))).sum())


def simplified(way: FloatArray, tolerance: float) -> FloatArray:
    """Return points (W, 2) of ``way`` (N, 2) within ``tolerance`` [m] of it.

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
    """Return the distances (N,) [m] from points (N, 2) to the segment from start to end."""
    along = end - start
    length2 = float(along @ along)
    share = np.clip((points - start) @ along / length2, 0.0, 1.0) if length2 else np.zeros(1)
    offset = points - start - np.multiply.outer(share, along)
    distance: FloatArray = np.sqrt(np.sum(offset * offset, axis=1))
    return distance


def distinct(points: FloatArray) -> FloatArray:
    """Return the points without those equal to their predecessor."""
    new = np.ones(len(points), np.bool_)
    new[1:] = np.any(points[1:] != points[:-1], axis=1)
    return points[new]


def arc_length(points: FloatArray) -> FloatArray:
    """Return the length (W,) [m] of the path up to each point (W, 2)."""
    step = np.diff(points, axis=0)
    return np.concatenate([[0.0], np.cumsum(np.sqrt(np.sum(step * step, axis=1)))])
