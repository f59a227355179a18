"""The planner on a navigation mesh."""

from weakref import WeakKeyDictionary

import numpy as np
from pydantic import Field

from benchnav.arrays import FloatArray
from benchnav.navigation import UNSOLVED, Map, PluginConfig

from ...common.clearance_planner import ClearanceConfig
from ...common.disc_planner import DiscPlanner, Query, frame_of
from .mesh import Mesh, mesh_of, nearest
from .taut_search import shortest_path
from .tile import Tiling, tiles_of, tiling
from .tile_store import TileStore

_AROUND = 1.0  # [m] of space around all obstacles


class NavMesh(DiscPlanner):
    """The shortest path through triangles of free space, by search over intervals of their sides.

    The search is Polyanya (Cui, Harabor & Grastien 2017). Polygons around obstacles replace the
    arcs around their corners, from outside, so the path is clear of obstacles; among these polygons
    it is the shortest. The triangles are a constrained Delaunay triangulation of square tiles of
    8 m. On a map that changes, for instance one that an agent learns, only tiles near the changes
    are triangulated again. The path is the same as from scratch.
    """

    class Config(ClearanceConfig):
        """Parameters."""

        segments: int = Field(8, ge=1, le=90, description="line segments per quarter of a circle")

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._meshes: WeakKeyDictionary[Map, dict[tuple[float, Tiling], Mesh]]
        self._meshes = WeakKeyDictionary()
        self._tiles = TileStore()

    def search(self, query: Query) -> tuple[FloatArray, int]:
        """Search; ends beside the mesh are connected to its nearest point if the motion is free."""
        mesh = self._mesh(query)
        x, y = query.start.tolist()
        begin, px, py, off = nearest(mesh, -1, x, y)
        if begin < 0 or not _may_go(query, x, y, px, py, off):
            return UNSOLVED, 1
        x, y = query.goal.tolist()
        end, qx, qy, off = nearest(mesh, int(mesh.part[begin]), x, y)
        reached = _may_go(query, x, y, qx, qy, off)
        if not reached and off > query.slack:
            return UNSOLVED, 2
        path = shortest_path(mesh, px, py, begin, qx, qy, end, len(mesh.to) + 1024)
        path = np.vstack([query.start, path, query.goal] if reached else [query.start, path])
        moved = np.any(path[1:] != path[:-1], axis=1)
        return np.asarray(path[np.concatenate([[True], moved])]), 2

    def _mesh(self, query: Query) -> Mesh:
        known = self._meshes.setdefault(query.map, {})
        tiles = tiling(frame_of(query, _AROUND))
        key = (query.inflation, tiles)
        if key not in known:
            inflation, segments = query.inflation, self.config.segments
            needed = tiles_of(query.map.capsules, inflation, segments, tiles)
            triangles = self._tiles.triangles(needed, inflation, segments)
            known[key] = mesh_of(triangles, tiles, query.map)
        return known[key]


def _may_go(query: Query, x: float, y: float, px: float, py: float, off: float) -> bool:
    """Whether the disc can move straight from (x, y), ``off`` [m] the mesh, to p on it."""
    free = query.checker
    return off == 0.0 or (free.point_is_free(x, y) and free.motion_is_free(x, y, px, py))
