"""Planners on an occupancy grid."""

from weakref import WeakKeyDictionary

import numpy as np
from pydantic import Field

from benchnav.arrays import Extent, FloatArray
from benchnav.navigation import UNSOLVED, Map, PluginConfig

from ...common.clearance_planner import ClearanceConfig, free_goal
from ...common.disc_planner import DiscPlanner, Query, frame_of
from .lattice import MAX_CELLS, Lattice, joined, lattice, size_of
from .search import Ends, search

_RINGS = (1, 3)  # rings of places to which ends are connected, tried in this order
_Key = tuple[float, float, Extent]  # inflation [m], cell [m], frame


class GridConfig(ClearanceConfig):
    """Parameters of both."""

    cell: float = Field(
        0.25, gt=0, description="[m] distance of neighbouring grid points; the first one is half a"
        " cell from the lower left corner of the map's bounds"
    )  # fmt: skip
    halvings: int = Field(
        2, ge=0, le=6, description="how many times the cell is halved if no path is found"
    )


class GridPlanner(DiscPlanner):
    """Places and steps of a disc on a grid, computed once for a map and a radius."""

    any_angle: bool

    class Config(GridConfig):
        """Parameters."""

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._lattices: WeakKeyDictionary[Map, dict[_Key, Lattice]] = WeakKeyDictionary()

    def nothing(self, map: Map, start: FloatArray, goal: FloatArray, radius: float) -> str:
        query = Query(map, start, goal, radius, 0.0, self.checker(map, radius))
        cells = [self.config.cell / 2**k for k in range(self.config.halvings + 1)]
        fit = [cell for cell in cells if self._fits(query, cell)]
        if not fit:
            return f"a grid of {cells[0]:g} m has more than {MAX_CELLS} places"
        return f"no path leads to the goal on a grid of {fit[-1]:g} m"

    def search(self, query: Query) -> tuple[FloatArray, int]:
        goal = free_goal(query.checker, query.goal, query.slack)
        if goal is None:
            return UNSOLVED, 0
        checks = 0
        for halvings in range(self.config.halvings + 1):
            cell = self.config.cell / 2**halvings
            if not self._fits(query, cell):
                break
            path, more = self._on(self._lattice(query, cell), query.start, goal)
            checks += more
            if len(path):
                return path, checks
        return UNSOLVED, checks

    def _on(self, grid: Lattice, start: FloatArray, goal: FloatArray) -> tuple[FloatArray, int]:
        (sx, sy), (gx, gy) = start.tolist(), goal.tolist()
        checks = 0
        for rings in _RINGS:
            first, last = joined(grid, sx, sy, rings), joined(grid, gx, gy, rings)
            checks += 8 * rings * rings
            if len(first[0]) and len(last[0]):
                path, more = search(grid, Ends(sx, sy, gx, gy, *first, *last), self.any_angle)
                checks += more
                if len(path):
                    return straightened(path), checks
        return UNSOLVED, checks

    def _fits(self, query: Query, cell: float) -> bool:
        columns, rows = size_of(frame_of(query, 2.0 * cell), cell)
        return columns * rows <= MAX_CELLS

    def _lattice(self, query: Query, cell: float) -> Lattice:
        known = self._lattices.setdefault(query.map, {})
        frame = frame_of(query, 2.0 * cell)
        key = (query.inflation, cell, frame)
        if key not in known:
            corner = (query.map.bounds[0], query.map.bounds[1])
            known[key] = lattice(query.map.capsules, query.inflation, cell, frame, corner)
        return known[key]


class AStar(GridPlanner):
    """A* (Hart, Nilsson & Raphael 1968) on an eight-connected grid, with the octile distance."""

    class Config(GridConfig):
        """Parameters."""

    any_angle = False


class ThetaStar(GridPlanner):
    """Theta* (Nash et al. 2007): corners of a path are grid points, segments have any angle."""

    class Config(GridConfig):
        """Parameters."""

    any_angle = True


def straightened(path: FloatArray) -> FloatArray:
    """Return the same path (W, 2) without repeated waypoints and those on a straight piece."""
    moved = np.any(path[1:] != path[:-1], axis=1)
    path = path[np.concatenate([[True], moved])]
    way = np.diff(path, axis=0)
    cross = way[:-1, 0] * way[1:, 1] - way[:-1, 1] * way[1:, 0]
    dot = np.sum(way[:-1] * way[1:], axis=1)
    bends = (np.abs(cross) > 1e-9 * np.abs(dot)) | (dot < 0.0)
    return np.asarray(path[np.concatenate([[True], bends, [True]])])
