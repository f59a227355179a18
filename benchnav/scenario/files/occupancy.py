"""Occupancy maps as solids: the outline of blocked cells, exact to the cell."""

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np

from benchnav.arena.solid import Kind, Solid
from benchnav.arrays import Extent, FloatArray
from benchnav.errors import MapError
from benchnav.geometry.contour import outlines
from benchnav.scenario.importers import movingai, ros_map
from benchnav.scenario.importers.grid import MAX_CELLS, Occupancy, demand_free

Format = Literal["movingai", "ros"]

__all__ = [
    "MAX_CELLS",
    "Format",
    "Occupancy",
    "occupancy_loops",
    "occupancy_solids",
    "read_occupancy",
    "trace",
]


def read_occupancy(path: Path | str, format: Format, cell: float | None = None) -> Occupancy:
    """Return the map in ``path``; ``cell`` [m] is a side (default: 1 m, ROS as in the file).

    Raises:
        MapError: it is not a map of that format.
    """
    if format == "movingai":
        return movingai.read_map(path, 1.0 if cell is None else cell)
    if format == "ros":
        return ros_map.read_map(path, cell)
    raise MapError(f"{path}:1: the format must be 'movingai' or 'ros'; got {format!r}.")


def trace(occupancy: Occupancy, unknown_is_free: bool = False) -> tuple[Solid, ...]:
    """Return walls around all blocked cells, one for each 8-connected set.

    The outside of the map is blocked and comes first. Agents cannot pass between two
    blocked cells that touch at a corner. Unknown cells are blocked unless
    ``unknown_is_free``.
    """
    blocked = ~occupancy.free(unknown_is_free)
    return tuple(
        Solid(Kind.WALL, tuple(occupancy.points(loop) for loop in outline.loops))
        for outline in outlines(blocked)
    )


def occupancy_solids(
    path: Path | str,
    format: Format,
    offset: Sequence[float] = (0.0, 0.0),
    cell: float | None = None,
    unknown_is_free: bool = False,
) -> tuple[tuple[Solid, ...], Extent]:
    """Return walls and bounds (xmin, ymin, xmax, ymax) [m] of an occupancy map.

    Args:
        path: a MovingAI ``.map`` file, or a map_server YAML file.
        format: `movingai` (y upwards, lower left corner at the origin) or `ros` (placed and
            rotated by the file's origin).
        offset: (x, y) [m] added to every point.
        cell: side of a cell [m]; None: 1 m for MovingAI, the file's resolution for ROS.
        unknown_is_free: whether agents may enter cells that are unknown in the map.

    Raises:
        MapError: the file is wrong, or no cell is free.
    """
    occupancy = read_occupancy(path, format, cell)
    demand_free(f"{path}:1", occupancy, unknown_is_free, "`unknown_is_free: true`")
    solids = trace(occupancy, unknown_is_free)
    shift = np.asarray(offset, np.float64)
    xmin, ymin, xmax, ymax = occupancy.bounds
    x, y = float(shift[0]), float(shift[1])
    moved = tuple(solid.moved(shift) for solid in solids)
    return moved, (xmin + x, ymin + y, xmax + x, ymax + y)


def occupancy_loops(
    path: Path | str, format: Format, cell: float | None = None, unknown_is_free: bool = False
) -> tuple[FloatArray, ...]:
    """Return the loops (V, 2) [m] of a map's blocked cells, as an obstacle in the open.

    Like `occupancy_solids`, in the map's own frame, but the outside of the map is free:
    obstacles end at the map's edge.

    Raises:
        MapError: the file is wrong, or no cell is blocked.
    """
    occupancy = read_occupancy(path, format, cell)
    blocked = ~occupancy.free(unknown_is_free)
    if not blocked.any():
        free, _, unknown = occupancy.counts
        raise MapError(
            f"{path}:1: an obstacle's map must have a blocked cell; {free} are free"
            f" and {unknown} are unknown."
        )
    _, *regions = outlines(np.pad(blocked, 1))  # the first outline is the outside
    return tuple(occupancy.points(loop - 1.0) for region in regions for loop in region.loops)
