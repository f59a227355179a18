"""The free space of a disc's centre, as polygons that lie completely within it."""

import math
from typing import Any

import numpy as np
import shapely

from benchnav.arrays import Extent, FloatArray
from benchnav.geometry import inside_solid, solid_index
from benchnav.navigation import Map

_GRID = 1e-9  # [m] to which corners are rounded: no side is so short that triangles have no area


def free_polygons(map: Map, inflation: float, frame: Extent, segments: int) -> list[Any]:
    """Return shapely polygons of the disc's free space in a frame; they touch at points at most.

    Args:
        map: the obstacles.
        inflation: [m] growth of the obstacles.
        frame: xmin, ymin, xmax, ymax [m].
        segments: sides of a polygon for a quarter of a circle; every side touches it.
    """
    grown = shapely.polygons(capsule_polygons(map.capsules, inflation, segments))
    blocked = shapely.union_all(grown, grid_size=_GRID)
    free = shapely.difference(shapely.box(*frame), blocked, grid_size=_GRID)
    parts = [part for part in shapely.get_parts(free) if part.geom_type == "Polygon"]
    # an area that no edge reaches lies either within a solid or outside all of them
    index = (map.capsules, *solid_index(map.solids))
    places = [part.representative_point() for part in parts]
    return [
        part
        for part, place in zip(parts, places, strict=True)
        if not inside_solid(place.x, place.y, *index)
    ]


def capsule_polygons(capsules: FloatArray, inflation: float, segments: int) -> FloatArray:
    """Return corners (P, 4 segments, 2) [m] of polygons around grown capsules (P, 5).

    Every side touches the capsule: straight flanks keep their place, arcs are
    approximated from outside, by at most radius (1 / cos(π / (4 segments)) - 1).
    """
    ends = capsules[:, :4].reshape(-1, 2, 2)
    along = ends[:, 1] - ends[:, 0]
    heading = np.arctan2(along[:, 1], along[:, 0])
    step = 0.5 * math.pi / segments
    turn = (np.arange(4 * segments) + 0.5) * step - 0.5 * math.pi  # around the head, then the tail
    angle = heading[:, None] + turn
    reach = (capsules[:, 4:] + inflation) / math.cos(0.5 * step)
    centre = np.repeat(ends[:, ::-1], 2 * segments, axis=1)
    out = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return np.asarray(centre + reach[..., None] * out)
