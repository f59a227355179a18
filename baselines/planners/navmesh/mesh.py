"""Triangles of free space, and the graph of places on their sides.

A path is searched over sides (portals), because the path through a triangle depends
on the sides by which it enters and leaves. The exact point on a side follows later,
by pulling a string; the search uses the midpoint, or on a long side several
places. With midpoints alone it would take detours around large triangles for shorter than
they are, and could choose the wrong side of an obstacle.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from benchnav.arrays import FloatArray, IntArray
from benchnav.errors import MissingExtraError
from benchnav.kernels import kernel

from .funnel import pulled

_START, _GOAL = -1, -2  # nodes in addition to the places 0, 1, …
_MAX_PLACES = 16  # on one side: a triangle has up to three times the square of this in links


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles, counter-clockwise; their portals are the sides that two of them share."""

    corner: FloatArray  # (T, 3, 2) [m]
    part: IntArray  # (T,) triangles with the same number are connected
    sides: tuple[tuple[int, ...], ...]  # (T,) places on each triangle's portals
    place: FloatArray  # (S, 2) [m] where the search may pass a portal
    portal: IntArray  # (S, 2, 2) triangle and side (k to k + 1) on both sides of the portal
    graph: Any  # networkx.Graph over places, weights in metres

    def nearest(self, x: float, y: float, part: int = -1) -> tuple[int, float, float, float]:
        """Return (triangle, its x, y, distance [m]) nearest to a point; -1 if there are none.

        With ``part``, only triangles of that part count.
        """
        triangle, px, py, far = _nearest(self.corner, self.part, part, x, y)
        return int(triangle), float(px), float(py), float(far)

    def path(self, start: FloatArray, begin: int, goal: FloatArray, end: int) -> FloatArray:
        """Return the taut path (W, 2) [m] from start in triangle ``begin`` to goal in ``end``.

        Both triangles must be of one part.
        """
        doors = self._doors(self._places(start, begin, goal, end), begin, end)
        return np.asarray(pulled(start, goal, doors))

    def _places(self, start: FloatArray, begin: int, goal: FloatArray, end: int) -> list[int]:
        """Return the places that the shortest path over places passes, by A*."""
        if begin == end:
            return []
        import networkx

        graph, place = self.graph, self.place
        gx, gy = goal.tolist()
        try:
            for node, at, triangle in ((_START, start, begin), (_GOAL, goal, end)):
                x, y = at.tolist()
                for n in self.sides[triangle]:
                    graph.add_edge(node, n, weight=math.hypot(place[n, 0] - x, place[n, 1] - y))

            def least(n: int, _: int) -> float:
                return 0.0 if n < 0 else math.hypot(place[n, 0] - gx, place[n, 1] - gy)

            nodes = networkx.astar_path(graph, _START, _GOAL, least, "weight")
        finally:
            graph.remove_nodes_from([_START, _GOAL])
        return list(nodes[1:-1])

    def _doors(self, places: list[int], begin: int, end: int) -> FloatArray:
        """Return left and right ends (K, 2, 2) [m] of the passed portals, in order.

        If a place only touches a portal (it lies on the straight line between two others
        of one triangle, or is the goal), the portal is not passed.
        """
        here = begin
        passed: list[tuple[int, int]] = []  # the triangle left, and its side
        for n in places:
            if here not in self.portal[n, :, 0]:
                here, _ = passed.pop()
            way = 0 if self.portal[n, 0, 0] == here else 1
            passed.append((here, int(self.portal[n, way, 1])))
            here = int(self.portal[n, 1 - way, 0])
        if here != end:
            passed.pop()
        doors = [self.corner[triangle, [(side + 1) % 3, side]] for triangle, side in passed]
        return np.array(doors).reshape(-1, 2, 2)


def mesh_of(polygons: list[Any], spacing: float) -> Mesh:
    """Return the mesh of free polygons: their constrained Delaunay triangles, by shapely.

    ``spacing`` [m] is the largest distance of places on a portal; there are at most sixteen.
    """
    found = shapely.constrained_delaunay_triangles(np.array(polygons, object))
    rings = shapely.get_coordinates(shapely.get_parts(found)).reshape(-1, 4, 2)[:, :3]
    corner = _counter_clockwise(rings)
    portal = _portals(corner)
    place, of = _places(corner, portal, spacing)
    sides: list[list[int]] = [[] for _ in corner]
    for n, pair in enumerate(portal[of, :, 0].tolist()):
        for triangle in pair:
            sides[triangle].append(n)
    graph = _graph(place, of, sides)
    return Mesh(
        corner, _parts(len(corner), portal), tuple(map(tuple, sides)), place, portal[of], graph
    )


def _counter_clockwise(rings: FloatArray) -> FloatArray:
    (ax, ay), (bx, by), (cx, cy) = (rings[:, k].T for k in range(3))
    clockwise = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) < 0.0
    corner = rings.copy()
    corner[clockwise] = rings[clockwise][:, ::-1]
    return np.ascontiguousarray(corner)


def _portals(corner: FloatArray) -> IntArray:
    """Return triangle and side (E, 2, 2) of both triangles at every shared side."""
    _, vertex = np.unique(corner.reshape(-1, 2), axis=0, return_inverse=True)
    tail = vertex.reshape(-1, 3)
    head = np.roll(tail, -1, axis=1)
    ends = np.stack([np.minimum(tail, head), np.maximum(tail, head)], axis=-1).reshape(-1, 2)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    same = np.flatnonzero(np.all(ends[order[1:]] == ends[order[:-1]], axis=1))
    pair = np.stack([order[same], order[same + 1]], axis=1)
    return np.stack([pair // 3, pair % 3], axis=-1)


def _places(corner: FloatArray, portal: IntArray, spacing: float) -> tuple[FloatArray, IntArray]:
    """Return places (S, 2) [m] in the middle of equal shares of portals, and the portals (S,)."""
    triangle, side = portal[:, 0, 0], portal[:, 0, 1]
    tail, head = corner[triangle, side], corner[triangle, (side + 1) % 3]
    exact = np.ceil(np.hypot(*(head - tail).T) / spacing)
    count = np.clip(exact, 1, _MAX_PLACES).astype(np.int64)
    of = np.repeat(np.arange(len(portal)), count)
    rank = np.arange(len(of)) - np.repeat(np.cumsum(count) - count, count)
    share = (rank + 0.5) / count[of]
    return tail[of] + share[:, None] * (head - tail)[of], of


def load_networkx() -> Any:
    """Return the module. Raise MissingExtraError if it is not installed."""
    try:
        import networkx
    except ImportError:
        raise MissingExtraError("The planner navmesh", "plan") from None
    return networkx


def _graph(place: FloatArray, of: IntArray, sides: list[list[int]]) -> Any:
    """Connect places on different portals of each triangle by their distance."""
    graph = load_networkx().Graph()
    graph.add_nodes_from(range(len(place)))
    at, which = place.tolist(), of.tolist()
    for own in sides:
        for k, n in enumerate(own):
            for m in own[:k]:
                if which[n] != which[m]:
                    graph.add_edge(n, m, weight=math.dist(at[n], at[m]))
    return graph


def _parts(count: int, portal: IntArray) -> IntArray:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    a, b = portal[:, 0, 0], portal[:, 1, 0]
    joined = coo_array((np.ones(len(a)), (a, b)), shape=(count, count))
    return np.asarray(connected_components(joined, directed=False)[1], np.int64)


@kernel
def _nearest(
    corner: FloatArray, part: IntArray, only: int, x: float, y: float
) -> tuple[int, float, float, float]:
    found, fx, fy, least = -1, x, y, math.inf
    for t in range(len(corner)):
        if only >= 0 and part[t] != only:
            continue
        inside = True
        for k in range(3):
            ax, ay = corner[t, k, 0], corner[t, k, 1]
            bx, by = corner[t, (k + 1) % 3, 0], corner[t, (k + 1) % 3, 1]
            dx, dy = bx - ax, by - ay
            if dx * (y - ay) - dy * (x - ax) >= 0.0:
                continue
            inside = False
            share = (dx * (x - ax) + dy * (y - ay)) / (dx * dx + dy * dy)
            share = min(max(share, 0.0), 1.0)
            qx, qy = ax + share * dx, ay + share * dy
            far = math.sqrt((x - qx) * (x - qx) + (y - qy) * (y - qy))
            if far < least:
                found, fx, fy, least = t, qx, qy, far
        if inside:
            return t, x, y, 0.0
    return found, fx, fy, least
