"""The planner on a navigation mesh."""

from weakref import WeakKeyDictionary

import numpy as np
from pydantic import Field

from benchnav.arrays import Extent, FloatArray
from benchnav.navigation import UNSOLVED, Map, PluginConfig

from ...common.clearance_planner import ClearanceConfig
from ...common.disc_planner import DiscPlanner, Query, frame_of
from .free_polygon import free_polygons
from .mesh import Mesh, load_networkx, mesh_of

_AROUND = 1.0  # [m] of space around all obstacles


class NavMesh(DiscPlanner):
    """A* over the sides of triangles of free space, then the funnel algorithm.

    The triangles are a constrained Delaunay triangulation, computed once for a map and a radius.
    The funnel algorithm (Mononen 2010) finds the shortest path through a sequence of triangles. The
    path is clear of obstacles: polygons outside the arcs around corners replace these arcs. The
    sequence of triangles is not always the best one.
    """

    class Config(ClearanceConfig):
        """Parameters."""

        segments: int = Field(8, ge=1, le=90, description="line segments per quarter of a circle")
        spacing: float = Field(
            1.0, gt=0, description="[m] largest distance between the points of a side at which"
            " the search can cross it; a shorter side has one point, its middle"
        )  # fmt: skip

    def __init__(self, config: PluginConfig | None = None) -> None:
        """Raise MissingExtraError if networkx is not installed."""
        super().__init__(config)
        load_networkx()
        self._meshes: WeakKeyDictionary[Map, dict[tuple[float, Extent], Mesh]]
        self._meshes = WeakKeyDictionary()

    def search(self, query: Query) -> tuple[FloatArray, int]:
        """Search; ends beside the mesh are connected to its nearest point if the motion is free."""
        mesh = self._mesh(query)
        x, y = query.start.tolist()
        begin, px, py, off = mesh.nearest(x, y)
        if begin < 0 or not _may_go(query, x, y, px, py, off):
            return UNSOLVED, 1
        x, y = query.goal.tolist()
        end, qx, qy, off = mesh.nearest(x, y, int(mesh.part[begin]))
        reached = _may_go(query, x, y, qx, qy, off)
        if not reached and off > query.slack:
            return UNSOLVED, 2
        path = mesh.path(np.array([px, py]), begin, np.array([qx, qy]), end)
        path = np.vstack([query.start, path, query.goal] if reached else [query.start, path])
        moved = np.any(path[1:] != path[:-1], axis=1)
        return np.asarray(path[np.concatenate([[True], moved])]), 2

    def _mesh(self, query: Query) -> Mesh:
        known = self._meshes.setdefault(query.map, {})
        frame = frame_of(query, _AROUND)
        key = (query.inflation, frame)
        if key not in known:
            free = free_polygons(query.map, query.inflation, frame, self.config.segments)
            known[key] = mesh_of(free, self.config.spacing)
        return known[key]


def _may_go(query: Query, x: float, y: float, px: float, py: float, off: float) -> bool:
    """Whether the disc can move straight from (x, y), ``off`` [m] the mesh, to p on it."""
    free = query.checker
    return off == 0.0 or (free.point_is_free(x, y) and free.motion_is_free(x, y, px, py))
