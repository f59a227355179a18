"""Shortest paths of a disc among capsules, exact except for rounding.

A shortest path of a disc's centre consists of straight motions that touch free
arcs, and of the arcs between them (the generalised visibility graph, Latombe
1991, chapter 4). The tangents of pairs of arcs are computed once; a query adds the tangents
from its start and to its goal, and searches.

A path ends where the centre reaches the goal disc, at the nearest reachable point of the
disc: straight towards the goal's centre, or, if an obstacle overlaps the goal disc, at a point
where the disc's rim meets the boundary of free space.
"""

import hashlib
import math
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.geometry.arc_polyline import around_arc
from benchnav.geometry.capsule_grid import SLACK, CapsuleGrid, capsule_grid, is_clear
from benchnav.geometry.free_arc import Arcs, free_arcs
from benchnav.geometry.geodesic_search import Found, Tangents, search, tangents
from benchnav.geometry.rim import arrivals
from benchnav.geometry.tangent import bitangents, point_tangents
from benchnav.kernels import kernel

_BEND = math.radians(10.0)  # largest turn at a waypoint of a polyline around an arc


class _Route(NamedTuple):
    length: float  # [m], NaN if there is no path
    end: FloatArray  # (2,) [m]
    leave: FloatArray | None = None  # (3,) link from the start; None: straight to the end
    arrive: FloatArray | None = None  # (3,) link to the end
    found: Found | None = None


@kernel
def _is_direct(grid: CapsuleGrid, sx: float, sy: float, ex: float, ey: float) -> tuple[bool, bool]:
    """Whether the disc is free at s, and whether it can move straight from s to e."""
    return is_clear(grid, sx, sy, sx, sy), is_clear(grid, sx, sy, ex, ey)


class FreeSpace:
    """The positions that the centre of a disc of ``radius`` [m] can take among capsules (P, 5).

    Loops must have the solid on their left. Touching is allowed, and so is
    overlap of up to 1e-8 m. Only edges are tested: a position deep inside a solid
    counts as free, although no path leads out of it. The graph is computed when a query
    first needs it.

    Raises:
        ValueError: the radius is not above 1e-8.
    """

    def __init__(self, capsules: FloatArray, radius: float) -> None:
        if not SLACK < radius < math.inf:
            raise ValueError(f"The radius must be > {SLACK} m; got {radius}.")
        self.radius = float(radius)
        self._grid = capsule_grid(capsules, self.radius)

    @cached_property
    def _arcs(self) -> Arcs:
        return free_arcs(self._grid)

    @cached_property
    def _graph(self) -> Tangents:
        return tangents(self._arcs, bitangents(self._grid, self._arcs))

    def is_free(self, place: FloatArray) -> bool:
        """Whether the disc at ``place`` (2,) [m] overlaps no capsule."""
        x, y = float(place[0]), float(place[1])
        return bool(is_clear(self._grid, x, y, x, y))

    def length(self, start: FloatArray, goal: FloatArray, tolerance: float = 0.0) -> float:
        """Return the length [m] of the shortest path from ``start`` (2,) to the goal disc.

        The goal disc has centre ``goal`` (2,) and radius ``tolerance`` [m]. The result is NaN if
        there is no path.
        """
        return self._route(start, goal, tolerance).length

    def path(
        self, start: FloatArray, goal: FloatArray, tolerance: float = 0.0, bend: float = _BEND
    ) -> FloatArray:
        """Return the same path as waypoints (W, 2) [m]; (0, 2) if there is none.

        Arcs become polylines around them: no corner is cut, and the sides are so short
        that they are as clear as the arcs. A waypoint on an arc turns by at most ``bend``
        [rad]; the polyline is longer than the arc by a share of bend² / 12 at most (0.3 %).
        """
        route = self._route(start, goal, tolerance)
        if math.isnan(route.length):
            return np.zeros((0, 2))
        points = [np.asarray(start, np.float64)]
        if route.leave is not None and route.arrive is not None and route.found is not None:
            points += self._around(route.leave, route.arrive, route.found, bend)
        points.append(route.end)
        line = np.array(points)
        moved = np.hypot(*np.diff(line, axis=0).T) > 1e-9
        kept: FloatArray = line[np.concatenate([[True], moved])]
        return kept

    def _route(self, start: FloatArray, goal: FloatArray, tolerance: float) -> _Route:
        sx, sy, gx, gy = float(start[0]), float(start[1]), float(goal[0]), float(goal[1])
        distance = math.hypot(gx - sx, gy - sy)
        no_route = _Route(math.nan, np.array([gx, gy]))
        share = max(distance - tolerance, 0.0) / max(distance, 1e-300)
        ex, ey = sx + share * (gx - sx), sy + share * (gy - sy)
        is_free, is_direct = _is_direct(self._grid, sx, sy, ex, ey)
        if not is_free:
            return no_route
        if distance <= tolerance:
            return _Route(0.0, np.array([sx, sy]))
        if is_direct:
            return _Route(distance - tolerance, np.array([ex, ey]))
        arrive, rim, owner, direct = arrivals(self._grid, self._arcs, sx, sy, gx, gy, tolerance)
        best = no_route
        for x, y in rim[direct]:
            straight = math.hypot(x - sx, y - sy)
            if not straight >= best.length:
                best = _Route(straight, np.array([x, y]))
        leave = point_tangents(self._grid, self._arcs, sx, sy, 0.0)
        if not len(leave) or not len(arrive):
            return best
        found = search(self._arcs, self._graph, leave, arrive, gx, gy, tolerance)
        if found.length == math.inf or found.length >= best.length:
            return best
        first, last = found.first, found.last
        if owner[last] >= 0:
            end = rim[owner[last]]
        else:
            share = tolerance / max(arrive[last, 2] + tolerance, 1e-300)
            end = (gx, gy) + share * (self._rim(arrive[last : last + 1])[0] - (gx, gy))
        return _Route(found.length, end, leave[first], arrive[last], found)

    def _rim(self, links: FloatArray) -> FloatArray:
        """Return the points (L, 2) on arcs of rows (L, ·) that begin with arc, angle."""
        arc = links[:, 0].astype(np.int64)
        turn = self._arcs.low[arc] + links[:, 1]
        out = np.stack([np.cos(turn), np.sin(turn)], axis=1)
        return np.asarray(self._arcs.center[arc] + self._arcs.radius[arc, None] * out)

    def _around(
        self, leave: FloatArray, arrive: FloatArray, found: Found, bend: float
    ) -> list[FloatArray]:
        graph, nodes = self._graph, found.nodes
        places = [leave[:2], *np.column_stack([graph.arc[nodes], graph.angle[nodes]]), arrive[:2]]
        straight = np.zeros(len(places) - 1, bool)
        straight[1:-1] = graph.other[nodes[:-1]] == nodes[1:]
        points = [self._rim(places[0][None])[0]]
        for here, there, jump in zip(places[:-1], places[1:], straight, strict=True):
            if not jump and here[1] != there[1]:
                points += list(self._bent(int(here[0]), here[1], there[1], bend))
            points.append(self._rim(there[None])[0])
        return points

    def _bent(self, arc: int, begin: float, end: float, bend: float) -> FloatArray:
        """Return the corners (N, 2) of the polyline around a piece of an arc."""
        (x, y), radius, low = self._arcs.center[arc], self._arcs.radius[arc], self._arcs.low[arc]
        return np.asarray(around_arc(self._grid, x, y, radius, low + begin, low + end, bend))


def geodesic_lengths(
    capsules: FloatArray, start: FloatArray, goal: FloatArray, radius: FloatArray, tolerance: float
) -> FloatArray:
    """Return the lengths (A,) [m] of the shortest paths of A discs among capsules; NaN: no path.

    Args:
        capsules: (P, 5), the obstacles, solid to the left of every loop.
        start: (A, 2) [m].
        goal: (A, 2) [m].
        radius: (A,) [m] of the discs; equal radii share a graph.
        tolerance: [m] radius of the goal disc, in which a path ends.

    Raises:
        ValueError: a radius is not above 1e-8.
    """
    query = [np.ascontiguousarray(x, np.float64).tobytes() for x in (capsules, start, goal, radius)]
    key = hashlib.blake2b(b"".join(query) + repr((*map(len, query), tolerance)).encode()).digest()
    if key not in _LENGTHS:
        if len(_LENGTHS) >= _MOST_LENGTHS:
            _LENGTHS.clear()
        spaces = [_space(query[0], float(r)) for r in radius]
        places = zip(spaces, start, goal, strict=True)
        _LENGTHS[key] = np.array([space.length(s, g, tolerance) for space, s, g in places])
    return _LENGTHS[key].copy()


# Every navigator of a suite runs in the same worlds. The key is a digest, so that no world is kept.
_LENGTHS: dict[bytes, FloatArray] = {}
_MOST_LENGTHS = 10_000


@lru_cache(maxsize=16)
def _space(capsules: bytes, radius: float) -> FreeSpace:
    """Return the free space from a cache: the next episode often has the same walls."""
    return FreeSpace(np.frombuffer(capsules).reshape(-1, 5), radius)
