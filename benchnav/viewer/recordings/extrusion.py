"""Solids as 3-D meshes: their outline, extruded upwards from the floor."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import shapely

from benchnav.arena.outline import outline
from benchnav.arena.solid import Kind, Solid, is_outside, signed_area
from benchnav.arena.world import World
from benchnav.arrays import Extent, FloatArray, IntArray

AGENT_HEIGHT = 1.2  # [m]
HEIGHT = {
    Kind.WALL: 1.5, Kind.STATIC: 1.0, Kind.DYNAMIC: 1.0, Kind.AGENT: AGENT_HEIGHT
}  # [m]  # fmt: skip
RIM = 0.2  # [m] how thick the wall around a walled arena is drawn
_SIDES = 24  # of a disc
_THIN = 0.02  # [m] half of how thick a wall without area is drawn


class Mesh(NamedTuple):
    """A triangle mesh."""

    vertices: FloatArray  # (V, 3) [m]
    triangles: IntArray  # (F, 3) indices of vertices, counter-clockwise seen from outside


def extrude(solid: Solid, bounds: Extent) -> Mesh:
    """Return the mesh of a solid. The outside of a walled arena ends near ``bounds``."""
    height = HEIGHT.get(Kind(solid.kind), 1.0)
    parts = [_prism(polygon, height) for polygon in _polygons(solid, bounds)]
    first = np.cumsum([0, *(len(part.vertices) for part in parts)])
    vertices = np.vstack([np.zeros((0, 3)), *(part.vertices for part in parts)])
    triangles = [part.triangles + n for part, n in zip(parts, first[:-1], strict=True)]
    return Mesh(vertices, np.vstack([np.zeros((0, 3), np.int64), *triangles]))


def extrude_agents(world: World) -> list[Mesh | None]:
    """Return the meshes of the agents about their centres; None for a disc."""
    shapes = [outline(world.agents, a) for a in range(len(world.agents))]
    return [
        None if shape is None else extrude(Solid(Kind.AGENT, (shape,)), world.bounds)
        for shape in shapes
    ]


def _polygons(solid: Solid, bounds: Extent) -> list[shapely.Polygon]:
    """Return the area of a solid; walls without area get a thickness."""
    if solid.is_disc:
        return [shapely.Point(solid.center).buffer(solid.radius, quad_segs=_SIDES // 4)]
    rings = [loop for loop in solid.loops if abs(signed_area(loop)) > 0.0]
    thin = [shapely.LineString(loop) for loop in solid.loops if signed_area(loop) == 0.0]
    area = shapely.union_all([line.buffer(_THIN, cap_style="flat") for line in thin])
    if is_outside(solid):
        x0, y0, x1, y1 = bounds
        area = area.union(shapely.box(x0 - RIM, y0 - RIM, x1 + RIM, y1 + RIM))
    for loop in sorted(rings, key=signed_area, reverse=True):  # holes are cut last
        ring = shapely.Polygon(loop).buffer(0.0)
        area = area.union(ring) if signed_area(loop) > 0.0 else area.difference(ring)
    parts = getattr(area, "geoms", [area])
    return [part for part in parts if isinstance(part, shapely.Polygon) and part.area > 0.0]


def _prism(polygon: shapely.Polygon, height: float) -> Mesh:
    """Return the top and the sides of a polygon (it stands on the floor) as triangles."""
    polygon = shapely.orient_polygons(polygon)  # outer ring counter-clockwise, holes clockwise
    vertices: list[FloatArray] = []
    triangles: list[IntArray] = []
    for triangle in shapely.constrained_delaunay_triangles(polygon).geoms:
        corners = np.asarray(shapely.orient_polygons(triangle).exterior.coords)[:3]
        triangles.append(np.arange(3) + 3 * len(vertices))
        vertices.append(np.column_stack([corners, np.full(3, height)]))
    first = 3 * len(vertices)
    for ring in (polygon.exterior, *polygon.interiors):
        points = np.asarray(ring.coords)
        for start, end in pairwise(points):
            quad = [(*start, 0.0), (*end, 0.0), (*end, height), (*start, height)]
            vertices.append(np.array(quad))
            triangles.append(np.array([[0, 1, 2], [0, 2, 3]]) + first)
            first += 4
    return Mesh(np.vstack(vertices), np.vstack(triangles))
