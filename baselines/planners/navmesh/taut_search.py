"""The shortest path through triangles: search over intervals of doors (Polyanya).

Michael Cui, Daniel Harabor and Alban Grastien, "Compromise-free Pathfinding on a Navigation Mesh",
IJCAI 2017. A node is an interval of a door that its root, the last turn of the path, sees whole
and straight. Its successors are intervals of the other doors of the triangle behind the door: those
that the root sees, and those that are reached by a turn at an end of the interval. The lower
bound of a node is the shortest way from its root through the interval to the goal, which is
mirrored if it is not behind the interval. The first node in the goal's triangle ends the
shortest path, whatever the triangles are.
"""

import math
from typing import NamedTuple

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.geometry.heap import pop, push
from benchnav.kernels import kernel, kernel_without_allocation

from .mesh import Mesh

_START = -1  # the root that is no vertex
_NONE, _NO_ROOM = -2, -3  # results of a search that are no nodes
_EPS = 1e-8  # [m] by which a point may be off a line: a corner is not lost to rounding


class _Nodes(NamedTuple):
    """_Nodes that were found."""

    place: (
        FloatArray  # (N, 5) left end x, y, right end x, y [m], length [m] of the path to the root
    )
    link: IntArray  # (N, 6) root, left and right end (vertices or -1), triangle, last one, parent
    key: FloatArray  # (N,) heap of waiting nodes: lower bounds [m]
    item: IntArray  # (N,) and nodes
    size: IntArray  # (2,) nodes, waiting nodes
    best: FloatArray  # (V,) [m] shortest path known to each vertex as a root


@kernel
def shortest_path(
    mesh: Mesh, sx: float, sy: float, begin: int, gx: float, gy: float, end: int, room: int
) -> FloatArray:
    """Return the shortest path (W, 2) [m] from s in triangle ``begin`` to g in ``end``.

    Both triangles must be of one part, else the path is (0, 2). A search that finds more than
    ``room`` nodes begins again with four times as many.
    """
    if begin == end:
        return np.array([[sx, sy], [gx, gy]])
    while True:
        nodes = _Nodes(
            np.empty((room, 5)), np.empty((room, 6), np.int64), np.empty(room),
            np.empty(room, np.int64), np.zeros(2, np.int64), np.full(len(mesh.vertex), math.inf),
        )  # fmt: skip
        last = _search(mesh, nodes, sx, sy, begin, gx, gy, end)
        if last != _NO_ROOM:
            break
        room *= 4
    path = np.empty((nodes.size[0] + 3, 2)) if last >= 0 else np.empty((0, 2))
    return path[_write(mesh, nodes, last, sx, sy, gx, gy, path) :]


@kernel_without_allocation
def _search(
    mesh: Mesh, nodes: _Nodes, sx: float, sy: float, begin: int, gx: float, gy: float, end: int
) -> int:
    """Return the node that ends the shortest path; `_NO_ROOM` if the arrays are too short."""
    if mesh.first[begin + 1] - mesh.first[begin] > len(nodes.item):
        return _NO_ROOM
    for d in range(mesh.first[begin], mesh.first[begin + 1]):
        _add(mesh, nodes, d, 0.0, 1.0, _START, 0.0, sx, sy, begin, -1, gx, gy)
    while nodes.size[1] > 0:
        n: int = nodes.item[0]
        nodes.size[1] = pop(nodes.key, nodes.item, nodes.size[1])
        root, triangle = nodes.link[n, 0], nodes.link[n, 3]
        if triangle == end:
            return n
        doors = mesh.first[triangle + 1] - mesh.first[triangle]
        if nodes.size[0] + 3 * doors > len(nodes.item):
            return _NO_ROOM
        if root == _START or nodes.place[n, 4] <= nodes.best[root] + _EPS:
            _expand(mesh, nodes, n, sx, sy, gx, gy)
    return _NONE


@kernel_without_allocation
def _expand(mesh: Mesh, nodes: _Nodes, n: int, sx: float, sy: float, gx: float, gy: float) -> None:
    """Add the successors of node n."""
    root, left, right = nodes.link[n, 0], nodes.link[n, 1], nodes.link[n, 2]
    t, last = nodes.link[n, 3], nodes.link[n, 4]
    lx, ly, rx, ry = nodes.place[n, 0], nodes.place[n, 1], nodes.place[n, 2], nodes.place[n, 3]
    far = nodes.place[n, 4]
    x, y = _point(mesh, root, sx, sy)
    wide = _distance(lx, ly, rx, ry)
    to_left, to_right = _distance(x, y, lx, ly), _distance(x, y, rx, ry)
    if abs(_cross(rx, ry, lx, ly, x, y)) <= _EPS * wide:  # the root is on the line of the door
        if to_left + to_right > wide + 2.0 * _EPS:  # but beside it: the path turns at its near end
            root, ahead = (left, to_left) if to_left <= to_right else (right, to_right)
            far += ahead
            if root < 0:
                return
            x, y = _point(mesh, root, sx, sy)
        for d in range(mesh.first[t], mesh.first[t + 1]):
            if mesh.to[d] != last:
                _add(mesh, nodes, d, 0.0, 1.0, root, far, x, y, t, n, gx, gy)
        return
    for d in range(mesh.first[t], mesh.first[t + 1]):
        if mesh.to[d] == last:
            continue
        ax, ay = _point(mesh, mesh.left[d], sx, sy)
        bx, by = _point(mesh, mesh.right[d], sx, sy)
        # shares of the door from its right end b to its left end a where the outer rays pass
        b_off, a_off = _cross(x, y, rx, ry, bx, by), _cross(x, y, rx, ry, ax, ay)
        low = _share(b_off / to_right, a_off / to_right, 0.0)
        b_off, a_off = _cross(x, y, lx, ly, bx, by), _cross(x, y, lx, ly, ax, ay)
        high = _share(b_off / to_left, a_off / to_left, 1.0)
        if high > low:
            _add(mesh, nodes, d, low, high, root, far, x, y, t, n, gx, gy)
        if left >= 0 and high < 1.0:
            _add(mesh, nodes, d, high, 1.0, left, far + to_left, lx, ly, t, n, gx, gy)
        if right >= 0 and low > 0.0:
            _add(mesh, nodes, d, 0.0, low, right, far + to_right, rx, ry, t, n, gx, gy)


@kernel_without_allocation
def _share(right: float, left: float, along: float) -> float:
    """Return the share of a door that is right of a ray, from the offsets [m] of its two ends.

    Offsets are positive to the left of the ray. The share is ``along`` if the ray leads along the
    door.
    """
    if right <= _EPS and left <= _EPS:
        return along if right >= -_EPS and left >= -_EPS else 1.0
    if right >= -_EPS and left >= -_EPS:
        return 0.0
    return right / (right - left)


@kernel_without_allocation
def _add(
    mesh: Mesh, nodes: _Nodes, d: int, low: float, high: float, root: int, far: float,
    x: float, y: float, triangle: int, parent: int, gx: float, gy: float,
) -> None:  # fmt: skip
    """Add the share ``low`` to ``high`` of door d, seen from (x, y), unless it is of no use."""
    if root != _START:
        if far > nodes.best[root] + _EPS:
            return
        nodes.best[root] = min(nodes.best[root], far)
    left, right = mesh.left[d], mesh.right[d]
    lx, ly = mesh.vertex[left, 0], mesh.vertex[left, 1]
    rx, ry = mesh.vertex[right, 0], mesh.vertex[right, 1]
    dx, dy = lx - rx, ly - ry
    if (high - low) * math.sqrt(dx * dx + dy * dy) <= _EPS:
        return
    if high < 1.0:
        lx, ly, left = rx + high * dx, ry + high * dy, -1
    if low > 0.0:
        rx, ry, right = rx + low * dx, ry + low * dy, -1
    n = nodes.size[0]
    nodes.place[n, 0], nodes.place[n, 1], nodes.place[n, 2] = lx, ly, rx
    nodes.place[n, 3], nodes.place[n, 4] = ry, far
    nodes.link[n, 0] = root
    nodes.link[n, 1] = left if left >= 0 and mesh.turns[left] else -1
    nodes.link[n, 2] = right if right >= 0 and mesh.turns[right] else -1
    nodes.link[n, 3], nodes.link[n, 4], nodes.link[n, 5] = mesh.to[d], triangle, parent
    bound = far + _through(x, y, lx, ly, rx, ry, gx, gy)[0]
    nodes.size[0] = n + 1
    nodes.size[1] = push(nodes.key, nodes.item, nodes.size[1], bound, n)


@kernel_without_allocation
def _through(
    x: float, y: float, lx: float, ly: float, rx: float, ry: float, gx: float, gy: float
) -> tuple[float, int]:
    """Return (length [m], end) of the shortest way from (x, y) through an interval to the goal.

    A goal that is not behind the interval is mirrored. The end at which the way turns is
    -1 for the left one, 1 for the right one, 0 for none.
    """
    off = _cross(rx, ry, lx, ly, gx, gy)
    if off > 0.0:
        dx, dy = lx - rx, ly - ry
        back = 2.0 * off / (dx * dx + dy * dy)
        gx, gy = gx + back * dy, gy - back * dx
    if _cross(x, y, lx, ly, gx, gy) > 0.0:
        return _distance(x, y, lx, ly) + _distance(lx, ly, gx, gy), -1
    if _cross(x, y, rx, ry, gx, gy) < 0.0:
        return _distance(x, y, rx, ry) + _distance(rx, ry, gx, gy), 1
    return _distance(x, y, gx, gy), 0


@kernel_without_allocation
def _write(
    mesh: Mesh, nodes: _Nodes, n: int, sx: float, sy: float, gx: float, gy: float,
    path: FloatArray,
) -> int:  # fmt: skip
    """Write the path through node n to the end of ``path``; return where it begins."""
    k = len(path)
    if k == 0:
        return k
    k -= 1
    path[k, 0], path[k, 1] = gx, gy
    x, y = _point(mesh, nodes.link[n, 0], sx, sy)
    lx, ly, rx, ry = nodes.place[n, 0], nodes.place[n, 1], nodes.place[n, 2], nodes.place[n, 3]
    side = _through(x, y, lx, ly, rx, ry, gx, gy)[1]
    if side != 0:
        k -= 1
        path[k, 0], path[k, 1] = (lx, ly) if side < 0 else (rx, ry)
    before = _NONE
    while n >= 0:
        root = nodes.link[n, 0]
        if root != before:
            k -= 1
            path[k, 0], path[k, 1] = _point(mesh, root, sx, sy)
            before = root
        n = nodes.link[n, 5]
    return k


@kernel_without_allocation
def _point(mesh: Mesh, root: int, sx: float, sy: float) -> tuple[float, float]:
    if root == _START:
        return sx, sy
    return mesh.vertex[root, 0], mesh.vertex[root, 1]


@kernel_without_allocation
def _cross(ax: float, ay: float, bx: float, by: float, px: float, py: float) -> float:
    """Return the cross product of ab and ap: positive if p lies left of the ray ab."""
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)


@kernel_without_allocation
def _distance(ax: float, ay: float, bx: float, by: float) -> float:
    return math.sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay))
