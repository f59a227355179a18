"""What says whether a disc may be somewhere, or go somewhere straight."""

from typing import Literal, Protocol

from benchnav.arrays import FloatArray, IntArray
from benchnav.geometry.capsule_grid import CapsuleGrid, capsule_grid, is_clear
from benchnav.geometry.sweep import inside_solid, solid_index
from benchnav.kernels import kernel
from benchnav.navigation.map import Map

SKIN = 1e-6  # [m] taken off the radius: an agent may stand in contact, give or take rounding

CheckerName = Literal["planar", "mesh"]


class Checker(Protocol):
    """Validity for one map and one radius."""

    def point_is_free(self, x: float, y: float) -> bool:
        """True where the disc may stand at (x, y) [m]: it overlaps nothing and is in no solid."""

    def motion_is_free(self, px: float, py: float, qx: float, qy: float) -> bool:
        """True where the disc may go straight from p, where it may stand, to q."""


class PlanarChecker:
    """The exact swept test against the map's solids."""

    def __init__(self, map: Map, radius: float) -> None:
        grid = capsule_grid(map.capsules, max(radius - SKIN, 0.0))
        self._grid: _Grid = (*grid,)
        self._solids = (map.capsules, *solid_index(map.solids))

    def point_is_free(self, x: float, y: float) -> bool:
        return _point_is_free(self._grid, self._solids, x, y)

    def motion_is_free(self, px: float, py: float, qx: float, qy: float) -> bool:
        return _motion_is_free(self._grid, px, py, qx, qy)


# A plain tuple crosses from Python into a kernel in a third of the time of a named one,
# and crossing is most of what a check costs.
_Grid = tuple[FloatArray, FloatArray, IntArray, IntArray, float, float, float, int, int]
_Solids = tuple[FloatArray, IntArray, IntArray]


@kernel
def _point_is_free(grid: _Grid, solids: _Solids, x: float, y: float) -> bool:
    return _motion_is_free(grid, x, y, x, y) and not inside_solid(
        x, y, solids[0], solids[1], solids[2]
    )


@kernel
def _motion_is_free(g: _Grid, px: float, py: float, qx: float, qy: float) -> bool:
    grid = CapsuleGrid(g[0], g[1], g[2], g[3], g[4], g[5], g[6], g[7], g[8])
    free: bool = is_clear(grid, px, py, qx, qy)
    return free


class CountingChecker:
    """Another checker, and how many motions it was asked about."""

    def __init__(self, checker: Checker) -> None:
        self._checker = checker
        self.checks = 0
        self.point_is_free = checker.point_is_free

    def motion_is_free(self, px: float, py: float, qx: float, qy: float) -> bool:
        self.checks += 1
        return self._checker.motion_is_free(px, py, qx, qy)


def checker_for(name: CheckerName, map: Map, radius: float) -> Checker:
    """The named checker of a map, for a disc of ``radius`` [m]."""
    if name == "planar":
        return PlanarChecker(map, radius)
    from .mesh_checker import MeshChecker

    return MeshChecker(map, radius)
