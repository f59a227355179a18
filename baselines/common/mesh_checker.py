"""Collision checks in three dimensions: the agent as an upright cylinder among meshes, by FCL.

The cylinder spans the agents' height band. The volume that it sweeps on a straight motion is
exactly the union of the cylinder at either end and of the upright box between them:
three discrete queries of the Flexible Collision Library (Pan, Chitta & Manocha 2012)
are a continuous test, up to the 1e-6 m to which FCL's own solver converges.

Solids that are not cut from a mesh are extruded. A place inside a closed mesh
touches none of its triangles, so the mesh's winding number is checked as well.
"""

import math
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from benchnav.arena import Mesh, Solid
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.errors import MissingExtraError
from benchnav.geometry import inside_solid, solid_index
from benchnav.navigation import Map
from benchnav.scenario.files.mesh_section import SIMPLIFY, THIN, section

SKIN = 1e-6  # [m] subtracted from the radius, as in the planar checker
_END = 1e-4  # [m] subtracted from the cylinder's ends: a floor at the band's edge is no obstacle
_FLAT = (0.0, 1.0)  # [m] band of a map without meshes
_SAME = SIMPLIFY + THIN  # [m] tolerance for a solid to be the outline of a mesh


class MeshChecker:
    """A `Checker` of one map for one radius, by python-fcl.

    Raises MissingExtraError if python-fcl is not installed.
    """

    def __init__(self, map: Map, radius: float) -> None:
        self._fcl = _load()
        self._obstacles = _obstacles_of(map)
        self._radius = max(radius - SKIN, SKIN)
        self._cylinders = [self._cylinder(layer.band) for layer in self._obstacles.layers]

    def point_is_free(self, x: float, y: float) -> bool:
        return self.motion_is_free(x, y, x, y) and not self._obstacles.hold(x, y)

    def motion_is_free(self, px: float, py: float, qx: float, qy: float) -> bool:
        fcl = self._fcl
        length = math.hypot(qx - px, qy - py)
        for layer, cylinder in zip(self._obstacles.layers, self._cylinders, strict=True):
            middle = 0.5 * (layer.band[0] + layer.band[1])
            parts = [(cylinder, fcl.Transform(np.array([px, py, middle])))]
            if length > 0.0:
                parts.append((cylinder, fcl.Transform(np.array([qx, qy, middle]))))
                c, s = (qx - px) / length, (qy - py) / length
                turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
                centre = np.array([0.5 * (px + qx), 0.5 * (py + qy), middle])
                box = fcl.Box(length, 2.0 * self._radius, _height(layer.band))
                parts.append((box, fcl.Transform(turn, centre)))
            if any(layer.touches(fcl.CollisionObject(*part)) for part in parts):
                return False
        return True

    def _cylinder(self, band: tuple[float, float]) -> Any:
        return self._fcl.Cylinder(self._radius, _height(band))


class _Layer:
    """Everything that an agent of one height band may touch."""

    def __init__(self, band: tuple[float, float]) -> None:
        self._fcl = _load()
        self.band = band
        self._manager = self._fcl.DynamicAABBTreeCollisionManager()
        self._kept: list[Any] = []  # the manager does not own its objects

    def add(self, vertices: FloatArray, faces: IntArray) -> None:
        model = self._fcl.BVHModel()
        model.beginModel(len(vertices), len(faces))
        model.addSubModel(vertices, faces)
        model.endModel()
        self._register(self._fcl.CollisionObject(model))

    def add_disc(self, solid: Solid) -> None:
        low, high = self.band
        shape = self._fcl.Cylinder(solid.radius, high - low)
        at = np.array([*solid.center, 0.5 * (low + high)])
        self._register(self._fcl.CollisionObject(shape, self._fcl.Transform(at)))

    def _register(self, thing: Any) -> None:
        self._kept.append(thing)
        self._manager.registerObject(thing)
        self._manager.setup()

    def touches(self, part: Any) -> bool:
        data = self._fcl.CollisionData()
        self._manager.collide(part, data, self._fcl.defaultCollisionCallback)
        return bool(data.result.is_collision)


class _Obstacles:
    """A map's meshes by height band, and its other solids extruded."""

    def __init__(self, map: Map) -> None:
        bands = sorted({mesh.band for mesh in map.meshes}) or [_FLAT]
        self.layers = [_Layer(band) for band in bands]
        self._meshes = map.meshes
        for mesh in map.meshes:
            faces = mesh.faces[_in_band(mesh)]
            if len(faces):
                self.layers[bands.index(mesh.band)].add(mesh.vertices, faces)
        regions = [section(mesh.vertices, mesh.faces, mesh.band) for mesh in map.meshes]
        solids = [s for s in map.solids if not any(_is_outline(s, region) for region in regions)]
        for solid in solids:
            if solid.is_disc:
                self.layers[0].add_disc(solid)
            else:
                self.layers[0].add(*extruded(solid, self.layers[0].band))
        capsules = [solid.capsules for solid in solids]
        self._capsules = np.vstack(capsules) if capsules else np.zeros((0, 5))
        self._first, self._outside = solid_index(solids)

    def hold(self, x: float, y: float) -> bool:
        """Whether the point lies inside a solid or a closed mesh."""
        if inside_solid(x, y, self._capsules, self._first, self._outside):
            return True
        for mesh in self._meshes:
            point = np.array([x, y, 0.5 * (mesh.band[0] + mesh.band[1])])
            if abs(winding_number(point, mesh.vertices[mesh.faces])) > 0.5:
                return True
        return False


_KNOWN: WeakKeyDictionary[Map, _Obstacles] = WeakKeyDictionary()


def _obstacles_of(map: Map) -> _Obstacles:
    if map not in _KNOWN:
        _KNOWN[map] = _Obstacles(map)
    return _KNOWN[map]


def extruded(solid: Solid, band: tuple[float, float]) -> tuple[FloatArray, IntArray]:
    """Return vertices (4 E, 3) and faces (2 E, 3) of upright rectangles over a solid's E edges."""
    edges = solid.capsules[:, :4].reshape(-1, 2, 2)
    count = len(edges)
    vertices = np.empty((count, 4, 3))
    vertices[:, (0, 2), :2] = edges
    vertices[:, (1, 3), :2] = edges
    vertices[:, (0, 2), 2], vertices[:, (1, 3), 2] = band
    first = 4 * np.arange(count)[:, None]
    faces = np.vstack([first + np.array([0, 2, 3]), first + np.array([0, 3, 1])])
    return vertices.reshape(-1, 3), faces


def winding_number(point: FloatArray, triangles: FloatArray) -> float:
    """Return the winding number of closed triangles (F, 3, 3) (van Oosterom & Strackee 1983)."""
    a, b, c = np.moveaxis(triangles - point, 1, 0)
    la, lb, lc = (np.sqrt((v * v).sum(axis=1)) for v in (a, b, c))
    volume = (a * np.cross(b, c)).sum(axis=1)
    ab, bc, ca = (a * b).sum(axis=1), (b * c).sum(axis=1), (c * a).sum(axis=1)
    angle = 2.0 * np.arctan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb)
    return float(angle.sum()) / (4.0 * math.pi)


def _in_band(mesh: Mesh) -> BoolArray:
    z = mesh.vertices[mesh.faces][..., 2]
    within: BoolArray = (z.max(axis=1) > mesh.band[0]) & (z.min(axis=1) < mesh.band[1])
    return within


def _is_outline(solid: Solid, region: Any) -> bool:
    """Whether the boundary of a solid runs along that of a mesh's section."""
    import shapely

    if solid.is_disc or region.is_empty:
        return False
    outline = shapely.multilinestrings([np.vstack([loop, loop[:1]]) for loop in solid.loops])
    near = shapely.buffer(shapely.boundary(region), _SAME)
    return bool(shapely.covers(near, outline))


def _height(band: tuple[float, float]) -> float:
    return max(band[1] - band[0] - 2.0 * _END, _END)


def _load() -> Any:
    try:
        import fcl
    except ImportError:
        raise MissingExtraError("The mesh checker", "plan") from None
    return fcl
