"""The position of each member along its group's path, and its next target.

Rows N are (world, agent) pairs, run by `benchnav.threads.run_rows`, and independent of each
other. Paths are concatenated in flat arrays; a group shares one.
"""

import math

from benchnav.arrays import BoolArray, ByteArray, FloatArray, IntArray
from benchnav.geometry import nearest_on_segment, segment_distance2
from benchnav.kernels import kernel

FREE, BLOCKED, CUT_OFF = 0, 1, 2  # obstacles that a member met, as `march` reports them
NEAR = 2  # shorter lookaheads that are tried if the full one is hidden: a half, a quarter
SIDES = 8  # places to either side of its own that a member tries
FOLDS = 16  # half lookaheads that are added at most where the corridor folds
CLOSE = 0.9  # share of the radius that must be free of edges: in a crowd, members touch walls


@kernel
def march(
    low: int, high: int, active: BoolArray, position: FloatArray, goal: FloatArray,
    radius: FloatArray, path: IntArray, offset: FloatArray, leave: FloatArray,
    first: IntArray, point: FloatArray, arc: FloatArray, lookahead: float, spread: float,
    edge_start: FloatArray, edge_end: FloatArray, edge_count: IntArray,
    progress: FloatArray, target: FloatArray, met: ByteArray,
) -> None:  # fmt: skip
    """Advance rows low … high - 1 along their paths.

    Args:
        low: first row.
        high: one past the last row.
        active: (N,) rows to update.
        position: (N, 2) [m].
        goal: (N, 2) [m] each member's own.
        radius: (N,) [m].
        path: (N,) index of the path; -1: none, the target is the goal.
        offset: (N,) [m] place in the corridor, to the left of the path.
        leave: (N,) [m] arc length at which a member heads for its own goal.
        first: (P+1,) where each path begins in the next two.
        point: (W, 2) [m].
        arc: (W,) [m] length of the path up to each point.
        lookahead: [m] between a member's place on the path and its target's.
        spread: [m] half width of the corridor; farther aside only around obstacles.
        edge_start: (N, E, 2) [m] edges of walls and obstacles that are sensed.
        edge_end: (N, E, 2) [m].
        edge_count: (N,).
        progress: (N,) [m] updated.
        target: (N, 2) [m] written.
        met: (N,) written: `FREE`, `BLOCKED` (an obstacle is on the path ahead) or
            `CUT_OFF` (an obstacle is between a member that left the path and its goal).
    """
    for i in range(low, high):
        if not active[i]:
            continue
        x, y, k = position[i, 0], position[i, 1], path[i]
        target[i, 0], target[i, 1], met[i] = goal[i, 0], goal[i, 1], FREE
        if k < 0:
            continue
        way, along = point[first[k] : first[k + 1]], arc[first[k] : first[k + 1]]
        here = advanced(way, along, progress[i], progress[i] + 2.0 * lookahead, x, y)
        progress[i] = here
        start, end, count = edge_start[i], edge_end[i], edge_count[i]
        if here >= leave[i]:
            reach = min(lookahead / math.hypot(goal[i, 0] - x, goal[i, 1] - y), 1.0)
            gx, gy = x + reach * (goal[i, 0] - x), y + reach * (goal[i, 1] - y)
            if not clear(start, end, count, x, y, gx, gy, CLOSE * radius[i]):
                met[i] = CUT_OFF
            continue
        if not way_is_clear(way, along, here, here + lookahead, start, end, count, 0.5 * radius[i]):
            met[i] = BLOCKED
        tx, ty = aim(
            way, along, here, x, y, radius[i], offset[i], spread, lookahead, start, end, count
        )
        if here + lookahead < along[-1] or math.hypot(tx - x, ty - y) > 0.1 * lookahead:
            target[i, 0], target[i, 1] = tx, ty  # otherwise it waits where the corridor ends


@kernel
def aim(
    way: FloatArray, along: FloatArray, here: float, x: float, y: float, radius: float,
    offset: float, spread: float, lookahead: float,
    start: FloatArray, end: FloatArray, count: int,
) -> tuple[float, float]:  # fmt: skip
    """Return the reachable place ahead, nearest to the member's own place in the corridor.

    Places inside the corridor come first, then those beside it (around an obstacle
    on the path), then nearer ones; the path itself if none is clear.
    """
    ahead = far_enough(way, along, here, x, y, offset, lookahead)
    for _ in range(NEAR + 1):
        qx, qy = at(way, along, here + ahead)
        ux, uy = direction(way, along, here + ahead, 0.5 * lookahead)
        for inside in (True, False):
            for n in range(2 * SIDES + 1):
                shift = (n + 1) // 2 * radius  # 0, 1, 1, 2, 2, … radii
                side = offset + (shift if n % 2 == 0 else -shift)
                if (abs(side) <= max(spread, abs(offset))) != inside:
                    continue
                tx, ty = qx - side * uy, qy + side * ux
                if clear(start, end, count, x, y, tx, ty, CLOSE * radius):
                    return tx, ty
        ahead *= 0.5
    return at(way, along, here + lookahead)


@kernel
def far_enough(
    way: FloatArray, along: FloatArray, here: float, x: float, y: float, offset: float,
    lookahead: float,
) -> float:  # fmt: skip
    """Return the smallest lookahead [m] at which the place in the corridor is ahead of the member.

    On the inner side of a bend the corridor folds: successive places along the
    path coincide, and a member would stand there for ever.
    """
    ahead = lookahead
    for _ in range(FOLDS):
        if here + ahead >= along[-1]:
            break
        qx, qy = at(way, along, here + ahead)
        ux, uy = direction(way, along, here + ahead, 0.5 * lookahead)
        if (qx - offset * uy - x) * ux + (qy + offset * ux - y) * uy >= 0.5 * lookahead:
            break
        ahead += 0.5 * lookahead
    return ahead


@kernel
def advanced(
    way: FloatArray, along: FloatArray, low: float, high: float, x: float, y: float
) -> float:
    """Return the arc length in low … high [m] where the path is nearest to (x, y), the first such.

    So progress never decreases, and does not jump to a later part of the path that is close.
    """
    best, found = math.inf, low
    for k in range(segment(along, low), len(along) - 1):
        if along[k] > high:
            break
        ax, ay = at(way, along, max(low, along[k]))
        bx, by = at(way, along, min(high, along[k + 1]))
        qx, qy = nearest_on_segment(x, y, ax, ay, bx, by)
        away = (x - qx) * (x - qx) + (y - qy) * (y - qy)
        if away < best:
            best = away
            found = max(low, along[k]) + math.sqrt((qx - ax) * (qx - ax) + (qy - ay) * (qy - ay))
    farthest: float = along[-1]
    return min(found, farthest)


@kernel
def segment(along: FloatArray, s: float) -> int:
    """Return the segment of arc length s, by bisection."""
    low, high = 0, len(along) - 1
    while high - low > 1:
        middle = (low + high) // 2
        if along[middle] <= s:
            low = middle
        else:
            high = middle
    return low


@kernel
def at(way: FloatArray, along: FloatArray, s: float) -> tuple[float, float]:
    """Return the point at arc length s; the path's ends beyond them."""
    if s <= 0.0:
        return way[0, 0], way[0, 1]
    if s >= along[-1]:
        return way[-1, 0], way[-1, 1]
    k = segment(along, s)
    t = (s - along[k]) / (along[k + 1] - along[k])
    return way[k, 0] + t * (way[k + 1, 0] - way[k, 0]), way[k, 1] + t * (way[k + 1, 1] - way[k, 1])


@kernel
def direction(way: FloatArray, along: FloatArray, s: float, half: float) -> tuple[float, float]:
    """Return the unit direction of the chord from s - half to s + half, smooth at corners."""
    middle = min(max(s, 0.0), along[-1])
    ax, ay = at(way, along, middle - half)
    bx, by = at(way, along, middle + half)
    dx, dy = bx - ax, by - ay
    length = math.sqrt(dx * dx + dy * dy)
    if length == 0.0:
        return 1.0, 0.0
    return dx / length, dy / length


@kernel
def clear(
    start: FloatArray, end: FloatArray, count: int, ax: float, ay: float, bx: float, by: float,
    radius: float,
) -> bool:  # fmt: skip
    """Whether a disc that moves from a to b touches no edge except those that it touches at a."""
    for k in range(count):
        x0, y0, x1, y1 = start[k, 0], start[k, 1], end[k, 0], end[k, 1]
        qx, qy = nearest_on_segment(ax, ay, x0, y0, x1, y1)
        now = (ax - qx) * (ax - qx) + (ay - qy) * (ay - qy)
        least = min(radius * radius, 0.999 * now)
        if segment_distance2(ax, ay, bx, by, x0, y0, x1, y1) < least:
            return False
    return True


@kernel
def way_is_clear(
    way: FloatArray, along: FloatArray, low: float, high: float,
    start: FloatArray, end: FloatArray, count: int, radius: float,
) -> bool:  # fmt: skip
    """Whether the path keeps ``radius`` from all edges between arc lengths low and high."""
    for k in range(segment(along, low), len(along) - 1):
        if along[k] > high:
            break
        ax, ay = at(way, along, max(low, along[k]))
        bx, by = at(way, along, min(high, along[k + 1]))
        for e in range(count):
            distance2 = segment_distance2(
                ax, ay, bx, by, start[e, 0], start[e, 1], end[e, 0], end[e, 1]
            )
            if distance2 < radius * radius:
                return False
    return True
