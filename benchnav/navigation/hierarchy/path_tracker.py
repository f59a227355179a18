"""The progress of each agent along its path, and its next target; shared by all controllers.

Progress never decreases, and follows the path without jumps: if the path returns on the
other side of a wall, the progress does not skip the part between.
"""

import numpy as np

from benchnav.arrays import AnyArray, BoolArray, FloatArray, IntArray
from benchnav.geometry.capsule import nearest_on_segment
from benchnav.kernels import kernel
from benchnav.navigation.controller import Guide
from benchnav.navigation.observation import Observation
from benchnav.threads import run_rows

_HALVINGS = 20  # bisections of a segment for the farthest target: to a millionth of its length


class PathTracker:
    """Paths of all rows and agents, and the progress along them.

    Args:
        lookahead: length of path [m] between an agent and its target, at most; the
            target is less far ahead where the path turns.
        cut: [m] by how much the straight way to the target may miss the path's
            corners, and how near a corner counts as passed.
    """

    def __init__(self, lookahead: float, cut: float) -> None:
        self.lookahead = lookahead
        self.cut = cut
        self._path = np.zeros((0, 0, 0, 2))
        self._arc = np.zeros((0, 0, 0))
        self._count = np.zeros((0, 0), np.int64)
        self._segment = np.zeros((0, 0), np.int64)
        self._progress = np.zeros((0, 0))
        self._ahead = np.zeros((0, 0))
        self._clearance = np.zeros((0, 0))

    def reset(self, row: int, step_length: FloatArray) -> None:
        """Remove the paths of ``row``; ``step_length`` (A,) [m] is the usual motion in one step.

        An agent looks at least two steps ahead, so that a near target does not slow it down.
        """
        agents = len(step_length)
        self._reserve(row + 1, agents, 0)
        self._count[row] = 0
        self._clearance[row] = np.inf
        self._ahead[row, :agents] = np.maximum(self.lookahead, 2.0 * step_length)

    def follow(
        self, row: int, agent: int, path: FloatArray, clearance: float | None = None
    ) -> None:
        """Start ``agent`` of ``row`` on ``path`` (W, 2) [m]; W = 0 means no path.

        The path leaves ``clearance`` [m] beside the agent; None: keep the value of the last path.
        """
        distinct = np.ones(len(path), np.bool_)
        distinct[1:] = np.any(path[1:] != path[:-1], axis=1)
        path = path[distinct]
        count = len(path)
        self._reserve(row + 1, agent + 1, count)
        length = np.sqrt(np.sum(np.diff(path, axis=0) ** 2, axis=1))
        self._path[row, agent, :count] = path
        self._arc[row, agent, :count] = np.concatenate([[0.0], np.cumsum(length)])[:count]
        self._count[row, agent] = count
        self._segment[row, agent] = 0
        self._progress[row, agent] = 0.0
        if clearance is not None:
            self._clearance[row, agent] = clearance

    def guide(self, observation: Observation) -> Guide:
        """Advance the active agents along their paths and return their targets."""
        worlds, agents = observation.active.shape
        rows = observation.rows
        self._reserve(int(rows.max(initial=-1)) + 1, agents, 0)
        target = observation.goal.copy()
        offset = target - observation.position
        remaining = np.sqrt(np.sum(offset * offset, axis=-1))
        run_rows(
            track, worlds, rows, observation.active, np.ascontiguousarray(observation.position),
            self._path, self._arc, self._count, self._ahead, self.cut,
            self._progress, self._segment, target, remaining,
        )  # fmt: skip
        has_path = self._count[rows, :agents] > 0
        return Guide(target, remaining, has_path, self._clearance[rows, :agents])

    def rest(self, row: int, agent: int) -> FloatArray:
        """Return the rest (W, 2) [m] of a path from the last known progress; W = 0: no path."""
        count, k = self._count[row, agent], self._segment[row, agent]
        way, arc = self._path[row, agent, :count], self._arc[row, agent, :count]
        if count < 2:
            return way.copy()
        share = (self._progress[row, agent] - arc[k]) / (arc[k + 1] - arc[k])
        here = way[k] + min(max(share, 0.0), 1.0) * (way[k + 1] - way[k])
        return np.vstack([here, way[k + 1 :]])

    def _reserve(self, rows: int, agents: int, waypoints: int) -> None:
        old = self._path.shape
        if old[0] >= rows and old[1] >= agents and old[2] >= waypoints:
            return
        capacity = old[0] if old[0] >= rows else max(rows, 2 * old[0])
        at = (capacity, max(old[1], agents))
        deep = (*at, max(old[2], waypoints))
        self._path = _grown(self._path, (*deep, 2))
        self._arc = _grown(self._arc, deep)
        self._count = _grown(self._count, at)
        self._segment = _grown(self._segment, at)
        self._progress = _grown(self._progress, at)
        self._ahead = _grown(self._ahead, at)
        self._clearance = _grown(self._clearance, at)


def _grown(old: AnyArray, shape: tuple[int, ...]) -> AnyArray:
    new = np.zeros(shape, old.dtype)
    new[tuple(slice(n) for n in old.shape)] = old
    return new


@kernel
def track(
    low: int, high: int, rows: IntArray, active: BoolArray, position: FloatArray,
    path: FloatArray, arc: FloatArray, count: IntArray, ahead: FloatArray, cut: float,
    progress: FloatArray, segment: IntArray, target: FloatArray, remaining: FloatArray,
) -> None:  # fmt: skip
    """Advance worlds low … high - 1 of ``rows`` (B,), see `PathTracker`.

    Args:
        low: first world.
        high: one past the last world.
        rows: (B,) the row of each world's paths.
        active: (B, A) True for agents to advance; the entries of others are unchanged.
        position: (B, A, 2) [m].
        path: (R, A, W, 2) [m] waypoints; successive ones differ.
        arc: (R, A, W) [m] length of the path up to each waypoint.
        count: (R, A) waypoints.
        ahead: (R, A) [m] lookahead.
        cut: [m] tolerance at corners.
        progress: (R, A) [m] updated.
        segment: (R, A) updated: the segment of ``progress``.
        target: (B, A, 2) [m] written for agents with a path that are not at its end.
        remaining: (B, A) [m] written for agents with a path.
    """
    for b in range(low, high):
        row = rows[b]
        for a in range(active.shape[1]):
            n = count[row, a]
            if n < 2 or not active[b, a]:
                continue
            x, y = position[b, a, 0], position[b, a, 1]
            way, along = path[row, a], arc[row, a]
            k, s = advanced(way, along, n, segment[row, a], progress[row, a], x, y, cut)
            segment[row, a], progress[row, a] = k, s
            remaining[b, a] = along[n - 1] - s
            ex, ey = way[n - 1, 0] - x, way[n - 1, 1] - y
            if ex * ex + ey * ey > cut * cut:
                qx, qy = _farthest(way, along, n, k, s + ahead[row, a], x, y, cut)
                target[b, a, 0], target[b, a, 1] = qx, qy


@kernel
def advanced(
    way: FloatArray, along: FloatArray, n: int, k: int, s: float, x: float, y: float, cut: float
) -> tuple[int, float]:
    """Return (segment, progress) of (x, y), searched forward from segment k and progress s.

    An agent passes a corner if it comes near it, or if it crosses the line through the corner
    that is perpendicular to the next segment.
    """
    while k < n - 1:
        ax, ay, bx, by = way[k, 0], way[k, 1], way[k + 1, 0], way[k + 1, 1]
        length = along[k + 1] - along[k]
        t = ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / length
        s = max(s, along[k] + min(max(t, 0.0), length))
        if k == n - 2:
            break
        fx, fy = x - bx, y - by
        near = fx * fx + fy * fy <= cut * cut
        beyond = t >= length and (fx * (way[k + 2, 0] - bx) + fy * (way[k + 2, 1] - by) > 0.0)
        if not (near or beyond):
            break
        k += 1
        s = max(s, along[k])
    return k, s


@kernel
def _farthest(
    way: FloatArray, along: FloatArray, n: int, k: int, reach: float, x: float, y: float, cut: float
) -> tuple[float, float]:
    """Return the farthest target (x, y) on the path, at most at arc length ``reach``.

    The straight line from the agent to it passes within ``cut`` of all corners between.
    """
    qx, qy = way[k + 1, 0], way[k + 1, 1]
    for j in range(k, n - 1):
        cx, cy = _point(way, along, j, min(reach, along[j + 1]))
        if not _straight(way, k + 1, j, x, y, cx, cy, cut):
            low, high = along[j], min(reach, along[j + 1])
            for _ in range(_HALVINGS):
                middle = 0.5 * (low + high)
                cx, cy = _point(way, along, j, middle)
                if _straight(way, k + 1, j, x, y, cx, cy, cut):
                    low = middle
                else:
                    high = middle
            return _point(way, along, j, low)
        qx, qy = cx, cy
        if reach <= along[j + 1]:
            break
    return qx, qy


@kernel
def _point(way: FloatArray, along: FloatArray, j: int, s: float) -> tuple[float, float]:
    """Return the point of segment j at arc length s."""
    t = (s - along[j]) / (along[j + 1] - along[j])
    return way[j, 0] + t * (way[j + 1, 0] - way[j, 0]), way[j, 1] + t * (way[j + 1, 1] - way[j, 1])


@kernel
def _straight(
    way: FloatArray, first: int, last: int, x: float, y: float, cx: float, cy: float, cut: float
) -> bool:
    """Whether the segment from (x, y) to c passes within ``cut`` of waypoints first … last."""
    for j in range(first, last + 1):
        qx, qy = nearest_on_segment(way[j, 0], way[j, 1], x, y, cx, cy)
        fx, fy = way[j, 0] - qx, way[j, 1] - qy
        if fx * fx + fy * fy > cut * cut:
            return False
    return True
