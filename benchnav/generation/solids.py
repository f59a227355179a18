"""Solids from shapes: draw numbers, rotate corners, order edges with the solid on the left."""

from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from benchnav.arena.mesh import Mesh as ArenaMesh
from benchnav.arena.solid import Kind, Solid
from benchnav.arrays import Extent, FloatArray
from benchnav.geometry.rotation import rotated
from benchnav.scenario.sampling.sampler import Scalar, sample
from benchnav.scenario.shape import Box, Disc, Mesh, Occupancy, Polygon, Polyline, Shape
from benchnav.scenario.wall import Place, Wall


def bounds_wall(bounds: Extent) -> Solid:
    """Return the wall along the bounds: one clockwise loop, solid outside."""
    x0, y0, x1, y1 = bounds
    return Solid(Kind.WALL, (np.array([[x0, y0], [x0, y1], [x1, y1], [x1, y0]], float),))


def draw_solid(
    shape: Shape, heading: Scalar, kind: Kind, rng: np.random.Generator, folder: Path = Path()
) -> Solid:
    """Return a solid about the origin; all parts of a mesh or a map form one solid.

    File names are relative to ``folder``.

    Raises MapError or MeshError if such a file is wrong.
    """
    if isinstance(shape, Disc):
        return Solid(kind, (), (0.0, 0.0), sample(shape.radius, rng))
    turn = sample(heading, rng)
    if isinstance(shape, Mesh | Occupancy):
        loops = _loops(shape, folder)
        return Solid(kind, loops if turn == 0.0 else tuple(rotated(loop, turn) for loop in loops))
    if isinstance(shape, Box):
        w = 0.5 * sample(shape.width, rng)
        d = w if shape.depth is None else 0.5 * sample(shape.depth, rng)
        loop = np.array([[-w, -d], [w, -d], [w, d], [-w, d]])
    elif isinstance(shape, Polygon):
        loop = counter_clockwise(np.array(shape.points))
    else:
        loop = _line_loop(shape)
    return Solid(kind, (loop if turn == 0.0 else rotated(loop, turn),))


def draw_wall(
    wall: Wall, place: Place, folder: Path, rng: np.random.Generator
) -> tuple[list[Solid], Any]:
    """Return the solids of a wall at one of its places, and its mesh (or None)."""
    shape = wall.shape
    if isinstance(shape, Occupancy):
        at = (float(place[0]), float(place[1]))  # type: ignore[arg-type] # plain numbers here
        path = folder / shape.file
        return list(_occupancy(path, shape.format, at, shape.cell, shape.unknown_is_free)), None
    if isinstance(shape, Mesh):
        at = (float(place[0]), float(place[1]))  # type: ignore[arg-type]
        yaw = float(wall.heading)  # type: ignore[arg-type]
        path = folder / shape.file
        solids, mesh = _mesh(
            path, shape.unit, shape.up, shape.scale, shape.band, yaw, at, Kind.WALL
        )
        return list(solids), mesh
    solid = draw_solid(shape, wall.heading, Kind.WALL, rng)
    return [solid.moved(np.array([sample(place[0], rng), sample(place[1], rng)]))], None


def _loops(shape: Mesh | Occupancy, folder: Path) -> tuple[FloatArray, ...]:
    """Return loops about the origin of the file's own frame."""
    path = folder / shape.file
    if isinstance(shape, Occupancy):
        return _occupancy_loops(path, shape.format, shape.cell, shape.unknown_is_free)
    about = (0.0, (0.0, 0.0), Kind.STATIC)
    solids, _ = _mesh(path, shape.unit, shape.up, shape.scale, shape.band, *about)
    return tuple(loop for solid in solids for loop in solid.loops)


@lru_cache(maxsize=32)
def _occupancy_loops(path: Path, *arguments: Any) -> tuple[FloatArray, ...]:
    from benchnav.scenario.files.occupancy import occupancy_loops

    return occupancy_loops(path, *arguments)


@lru_cache(maxsize=8)
def _occupancy(path: Path, *arguments: Any) -> tuple[Solid, ...]:
    from benchnav.scenario.files.occupancy import occupancy_solids

    return occupancy_solids(path, *arguments)[0]


@lru_cache(maxsize=32)
def _mesh(path: Path, *arguments: Any) -> tuple[tuple[Solid, ...], ArenaMesh]:
    from benchnav.scenario.files.mesh_section import mesh_solids

    return mesh_solids(path, *arguments)


def counter_clockwise(loop: FloatArray) -> FloatArray:
    """Return the loop (V, 2) in counter-clockwise order."""
    x, y = loop[:, 0], loop[:, 1]
    area = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    return loop if area > 0.0 else np.ascontiguousarray(loop[::-1])


def is_convex(solid: Solid) -> bool:
    """Whether a solid is a disc or a single convex loop."""
    if solid.is_disc:
        return True
    if len(solid.loops) > 1:
        return False
    edge = np.roll(solid.loops[0], -1, axis=0) - solid.loops[0]
    following = np.roll(edge, -1, axis=0)
    return bool(np.all(edge[:, 0] * following[:, 1] - edge[:, 1] * following[:, 0] > 0.0))


def _line_loop(shape: Polyline) -> FloatArray:
    points = np.array(shape.points)
    if shape.thickness == 0.0:
        return np.vstack([points, points[-2:0:-1]])
    import shapely

    band = shapely.LineString(points).buffer(
        0.5 * shape.thickness, cap_style="flat", join_style="mitre"
    )
    return counter_clockwise(np.array(band.exterior.coords)[:-1])


def polygon_solids(blocked: Any, kind: Kind) -> list[Solid]:
    """Return the solids of a shapely polygon or multipolygon."""
    import shapely

    solids = []
    for part in shapely.get_parts(blocked):
        whole = shapely.orient_polygons(part)
        rings = [whole.exterior, *whole.interiors]
        solids.append(Solid(kind, tuple(np.array(ring.coords)[:-1] for ring in rings)))
    return solids
