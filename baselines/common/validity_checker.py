"""Collision checkers: whether a disc may be at a place, or move straight to another."""

from functools import partial
from typing import Any, Literal, Protocol, cast
from weakref import WeakKeyDictionary

from benchnav.arrays import FloatArray, IntArray
from benchnav.geometry import CapsuleGrid, SolidRows, inside_rows, is_clear, solid_rows
from benchnav.geometry.capsule_grid import capsule_grid
from benchnav.kernels import kernel
from benchnav.navigation import Map

SKIN = 1e-6  # [m] subtracted from the radius: an agent may be in contact, up to rounding

CheckerName = Literal["planar", "mesh"]


class Checker(Protocol):
    """Collision checks for one map and one radius."""

    def point_is_free(self, x: float, y: float) -> bool:
        """Whether the disc may be at (x, y) [m]: it overlaps no obstacle and is in no solid."""

    def motion_is_free(self, px: float, py: float, qx: float, qy: float) -> bool:
        """Whether the disc may move straight from p, a free place, to q."""


class PlanarChecker:
    """The exact swept test against the map's solids."""

    def __init__(self, map: Map, radius: float) -> None:
        grid = (*capsule_grid(map.capsules, max(radius - SKIN, 0.0)),)
        # the code for Python itself: a planner calls it a hundred thousand times
        self.motion_is_free = partial(cast(Any, _motion_is_free).for_python, grid)
        self.point_is_free = partial(cast(Any, _point_is_free).for_python, grid, _rows_of(map))


_KNOWN: WeakKeyDictionary[Map, "_Rows"] = WeakKeyDictionary()


def _rows_of(map: Map) -> "_Rows":
    if map not in _KNOWN:
        _KNOWN[map] = (*solid_rows(map.solids),)
    return _KNOWN[map]


# Passing a plain tuple from Python to a kernel takes a third of the time of a named tuple,
# and this is most of the cost of a check.
_Grid = tuple[FloatArray, FloatArray, IntArray, IntArray, float, float, float, int, int]
_Rows = tuple[FloatArray, IntArray, IntArray, float, float, IntArray, int]


@kernel
def _point_is_free(grid: _Grid, r: _Rows, x: float, y: float) -> bool:
    rows = SolidRows(r[0], r[1], r[2], r[3], r[4], r[5], r[6])
    return _motion_is_free(grid, x, y, x, y) and not inside_rows(rows, x, y)


@kernel
def _motion_is_free(g: _Grid, px: float, py: float, qx: float, qy: float) -> bool:
    grid = CapsuleGrid(g[0], g[1], g[2], g[3], g[4], g[5], g[6], g[7], g[8])
    free: bool = is_clear(grid, px, py, qx, qy)
    return free


class CountingChecker:
    """Another checker, with a count of the motions that it checked."""

    def __init__(self, checker: Checker) -> None:
        self._checker = checker
        self.checks = 0
        self.point_is_free = checker.point_is_free

    def motion_is_free(self, px: float, py: float, qx: float, qy: float) -> bool:
        self.checks += 1
        return self._checker.motion_is_free(px, py, qx, qy)


def checker_for(name: CheckerName, map: Map, radius: float) -> Checker:
    """Return the named checker of a map, for a disc of ``radius`` [m]."""
    if name == "planar":
        return PlanarChecker(map, radius)
    from .mesh_checker import MeshChecker

    return MeshChecker(map, radius)
