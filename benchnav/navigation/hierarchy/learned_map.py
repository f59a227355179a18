"""The map that an agent has learned, as capsules that its sensors may contradict.

Rows of capsules are x0, y0, x1, y1, radius [m]; each has an owner: the solid of the
granted map that it belongs to (0, 1, …), or one of the codes below.
"""

import math

from benchnav.arena.solid import Kind
from benchnav.arrays import BoolArray, ByteArray, FloatArray, IntArray
from benchnav.geometry.rotation import cos_sin
from benchnav.geometry.sweep import is_free_of
from benchnav.kernels import kernel

SENSED_EDGE = -1  # an edge, or a disc made of sensed edges; exact
GUESSED = -2  # an obstacle somewhere on the front half of a ray's stopped disc

_EIGHTH = math.sqrt(0.5)  # cosine and sine of 45°
_APOTHEM = 0.5 + _EIGHTH  # of a regular octagon of side 1
_CORNER = math.sqrt(1.0 + 0.25 / _APOTHEM**2)  # distance of its corners, of apothem 1
SAME = 1e-6  # [m] within which two edges lie on one line, or meet
DOT = 0.05  # [m] radius of the disc that represents a guess
FURTHER = 0.1  # [m] of further motion within which a known capsule explains why a disc stopped
DOUBT = 0.1  # [m] by which a ray's disc must enter a capsule to contradict it: the cut side of an
# octagon lies outside of its disc, and guesses are not exact
_WALL, _STATIC = int(Kind.WALL), int(Kind.STATIC)


@kernel
def learn(
    low: int, high: int, rows: IntArray, active: BoolArray, order: IntArray, shared: bool,
    guess: bool, position: FloatArray, heading: FloatArray, radius: FloatArray, angle: FloatArray,
    distance: FloatArray, kind: ByteArray, edges: FloatArray, known: IntArray,
    capsules: FloatArray, owner: IntArray, count: IntArray, version: IntArray,
) -> None:  # fmt: skip
    """Update the maps of worlds low … high - 1 with the sensor data of their active agents.

    Args:
        low: first world.
        high: one past the last world.
        rows: (B,) the row of each world's maps.
        active: (B, A) True for agents that sense.
        order: (R, A) of processing the agents of a row; independent of their numbering.
        shared: all agents of a world write one map.
        guess: whether obstacles that stop rays are mapped, too.
        position: (B, A, 2) [m].
        heading: (B, A) [rad].
        radius: (B, A) [m] of the discs that are cast along the rays.
        angle: (K,) [rad] of the rays from the heading.
        distance: (B, A, K) [m].
        kind: (B, A, K) of Kind.
        edges: (B, A, E, 8) ends [m], directions of the edges before and after.
        known: (B, A) number of edges.
        capsules: (R, M, N, 5) of M maps, with room for one per ray and edge of this call.
        owner: (R, M, N).
        count: (R, M) number of capsules.
        version: (R, M) rises when a map changes.
    """
    for b in range(low, high):
        row = rows[b]
        for k in range(active.shape[1]):
            a = order[row, k]
            if a < 0 or a >= active.shape[1] or not active[b, a]:
                continue
            m = 0 if shared else a
            held, owners = capsules[row, m], owner[row, m]
            n, changed = count[row, m], False
            x, y, r = position[b, a, 0], position[b, a, 1], radius[b, a]
            for t in range(distance.shape[2]):
                d = distance[b, a, t]
                ux, uy = cos_sin(heading[b, a] + angle[t])
                left = without_contradicted(held, owners, n, x, y, x + d * ux, y + d * uy, r)
                changed, n = changed or left != n, left
                if guess and kind[b, a, t] in (_WALL, _STATIC):
                    more = with_guess(held, owners, n, x + d * ux, y + d * uy, ux, uy, r)
                    changed, n = changed or more != n, more
            for e in range(known[b, a]):
                n, new = with_edge(held, owners, n, edges[b, a, e])
                changed = changed or new
            count[row, m] = n
            version[row, m] += changed


@kernel
def without_contradicted(
    held: FloatArray, owners: IntArray, n: int, px: float, py: float, qx: float, qy: float, r: float
) -> int:
    """Remove the capsules that contradict the free motion of a disc of radius r from p to q.

    Returns the number of capsules left. A solid of the granted map is removed as a whole.
    """
    gone = 0
    reach = r - min(DOUBT, 0.5 * r)
    for k in range(n):
        if not is_free_of(px, py, qx, qy, reach, held[k]):
            gone += 1
            if owners[k] >= 0:
                for j in range(n):
                    if owners[j] == owners[k] and j != k:
                        held[j, 4] = -1.0
            held[k, 4] = -1.0
    return _compacted(held, owners, n) if gone else n


@kernel
def _compacted(held: FloatArray, owners: IntArray, n: int) -> int:
    """Drop the capsules of negative radius, keeping the order of the others."""
    kept = 0
    for k in range(n):
        if held[k, 4] >= 0.0:
            if kept != k:
                held[kept] = held[k]
                owners[kept] = owners[k]
            kept += 1
    return kept


@kernel
def with_guess(
    held: FloatArray, owners: IntArray, n: int, cx: float, cy: float, ux: float, uy: float, r: float
) -> int:
    """Add a dot straight ahead of a disc that stopped at c, unless a known capsule explains it.

    Returns the number of capsules.
    """
    ex, ey = cx + FURTHER * ux, cy + FURTHER * uy
    for k in range(n):
        if not is_free_of(cx, cy, ex, ey, r, held[k]):
            return n
    x, y = cx + (r + DOT) * ux, cy + (r + DOT) * uy
    held[n, 0], held[n, 1], held[n, 2], held[n, 3], held[n, 4] = x, y, x, y, DOT
    owners[n] = GUESSED
    return n + 1


@kernel
def with_edge(held: FloatArray, owners: IntArray, n: int, edge: FloatArray) -> tuple[int, bool]:
    """Add an edge (8,), or the disc that is sensed as an octagon around it.

    Returns the number of capsules, and whether the edge changes the map.
    """
    x0, y0, x1, y1 = edge[0], edge[1], edge[2], edge[3]
    length = math.sqrt((x1 - x0) * (x1 - x0) + (y1 - y0) * (y1 - y0))
    if length < SAME:
        return n, False
    ux, uy = (x1 - x0) / length, (y1 - y0) / length
    for k in range(n):
        if owners[k] != GUESSED and _covers(held[k], x0, y0, x1, y1, ux, uy, length):
            return n, False
    if _turns_an_eighth(edge[4], edge[5], ux, uy) and _turns_an_eighth(ux, uy, edge[6], edge[7]):
        r = _APOTHEM * length
        return _with_disc(held, owners, n, 0.5 * (x0 + x1) - r * uy, 0.5 * (y0 + y1) + r * ux, r)
    return _joined(held, owners, n, x0, y0, x1, y1, ux, uy, length)


@kernel
def _turns_an_eighth(ax: float, ay: float, bx: float, by: float) -> bool:
    """Whether direction b is direction a turned left by 45°, like the sides of an octagon."""
    c, s = ax * bx + ay * by, ax * by - ay * bx
    return abs(c - _EIGHTH) < SAME and abs(s - _EIGHTH) < SAME


@kernel
def _with_disc(
    held: FloatArray, owners: IntArray, n: int, x: float, y: float, r: float
) -> tuple[int, bool]:
    """Add a disc in place of sides of its octagon that were cut at the sensor's range."""
    held[n, 0], held[n, 1], held[n, 2], held[n, 3], held[n, 4] = x, y, x, y, r
    for k in range(n):
        h = held[k]
        length = math.sqrt((h[2] - h[0]) * (h[2] - h[0]) + (h[3] - h[1]) * (h[3] - h[1]))
        if owners[k] == SENSED_EDGE and h[4] == 0.0 and length > 0.0:
            ux, uy = (h[2] - h[0]) / length, (h[3] - h[1]) / length
            if _covers(held[n], h[0], h[1], h[2], h[3], ux, uy, length):
                h[4] = -1.0
    owners[n] = SENSED_EDGE
    return _compacted(held, owners, n + 1), True


@kernel
def _joined(
    held: FloatArray, owners: IntArray, n: int, x0: float, y0: float, x1: float, y1: float,
    ux: float, uy: float, length: float,
) -> tuple[int, bool]:  # fmt: skip
    """Add an edge, merged with the sensed edges on its line that it overlaps or meets."""
    low, high, joined = 0.0, length, False
    ax, ay, bx, by = x0, y0, x1, y1
    for k in range(n):
        h = held[k]
        if owners[k] != SENSED_EDGE or h[4] != 0.0 or not _on_line(h, x0, y0, ux, uy):
            continue
        s = (h[0] - x0) * ux + (h[1] - y0) * uy
        t = (h[2] - x0) * ux + (h[3] - y0) * uy
        if min(s, t) > high + SAME or max(s, t) < low - SAME:
            continue
        for end in range(2):
            at, ex, ey = (s, h[0], h[1]) if end == 0 else (t, h[2], h[3])
            if at < low:
                low, ax, ay = at, ex, ey
            if at > high:
                high, bx, by = at, ex, ey
        h[4] = -1.0
        joined = True
    if joined:
        n = _compacted(held, owners, n)
    held[n, 0], held[n, 1], held[n, 2], held[n, 3], held[n, 4] = ax, ay, bx, by, 0.0
    owners[n] = SENSED_EDGE
    return n + 1, True


@kernel
def _covers(
    h: FloatArray, x0: float, y0: float, x1: float, y1: float, ux: float, uy: float, length: float
) -> bool:
    """Whether the edge is part of capsule h, or of a side of the octagon around it."""
    if h[4] > 0.0:
        fx, fy, gx, gy = x0 - h[0], y0 - h[1], x1 - h[0], y1 - h[1]
        corner = h[4] * _CORNER + SAME
        near = max(fx * fx + fy * fy, gx * gx + gy * gy) <= corner * corner
        return bool(near and abs(abs(fx * uy - fy * ux) - h[4]) < SAME)
    if not _on_line(h, x0, y0, ux, uy):
        return False
    s = (h[0] - x0) * ux + (h[1] - y0) * uy
    t = (h[2] - x0) * ux + (h[3] - y0) * uy
    return bool(min(s, t) <= SAME and max(s, t) >= length - SAME)


@kernel
def _on_line(h: FloatArray, x0: float, y0: float, ux: float, uy: float) -> bool:
    """Whether both ends of capsule h lie on the line through (x0, y0) along u."""
    first = (h[0] - x0) * uy - (h[1] - y0) * ux
    second = (h[2] - x0) * uy - (h[3] - y0) * ux
    return bool(abs(first) < SAME and abs(second) < SAME)


@kernel
def way_is_free(way: FloatArray, radius: float, capsules: FloatArray) -> bool:
    """Whether a disc of ``radius`` [m] can move along the path ``way`` (W, 2) among capsules."""
    for k in range(len(way) - 1):
        for c in range(len(capsules)):
            if not is_free_of(
                way[k, 0], way[k, 1], way[k + 1, 0], way[k + 1, 1], radius, capsules[c]
            ):
                return False
    return True
