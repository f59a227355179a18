"""Walls around recorded people: a walkable area, a hull of their places, or a map."""

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.config.document import shown
from benchnav.errors import BenchnavError, MapError, UsageError
from benchnav.scenario.base import FAR
from benchnav.scenario.importers.grid import read_bytes

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry

Wall = dict[str, Any]

MARGIN = 1.0  # [m] from the people's places to the hull
_MAX_BYTES = 16 << 20
_MOST = 900  # corners of one wall
_FINE = 1e-3  # [m] a corner that is nearer to the line of its neighbours is left out
_FRAME = 0.1  # [m] that the area of a Vadere scenario is widened
_IMAGES = (".png", ".pgm", ".bmp", ".jpg", ".jpeg", ".tif", ".tiff", ".gif")


def hull_of(places: FloatArray) -> "BaseGeometry":
    """Return the convex hull of places (N, 2) [m], `MARGIN` wider."""
    import shapely

    return shapely.MultiPoint(places).convex_hull.buffer(MARGIN, join_style="mitre")


def read_area(path: Path) -> "BaseGeometry":
    """Return the walkable area [m] in a file: WKT, a Vadere scenario or a Crowd:it geometry.

    Raises MapError if it is none of these.
    """
    content = read_bytes(path, _MAX_BYTES, "a file of walls")
    try:
        if path.suffix == ".scenario":
            import pedpy

            area = pedpy.load_walkable_area_from_vadere_scenario(
                vadere_scenario_file=path,
                margin=_FRAME,  # obstacles may touch the frame
            )
            return area.polygon
        if path.suffix in (".floor", ".xml"):
            import pedpy

            return pedpy.load_walkable_area_from_crowdit(geometry_file=path).polygon
        return _wkt(path, content)
    except BenchnavError:
        raise
    except (Exception, RecursionError) as error:  # GEOS, pedpy and expat raise many kinds
        reason = shown(" ".join(str(error).split()).removesuffix("."), 160)
        raise MapError(
            f"{path}:1: must be the walkable area as WKT (.wkt), a Vadere scenario (.scenario), a"
            f" Crowd:it geometry (.floor), or a ROS map (.yaml); got: {reason}."
        ) from None


def _wkt(path: Path, content: bytes) -> "BaseGeometry":
    import shapely

    area = shapely.from_wkt(content.decode("utf-8-sig").strip())
    if area is None or area.is_empty:
        raise MapError(f"{path}:1: the walkable area must not be empty.")
    x0, y0, x1, y1 = area.bounds
    if not max(abs(x0), abs(y0), abs(x1), abs(y1)) <= FAR:
        raise MapError(
            f"{path}:1: coordinates must be metres within ± {FAR:g}; the area spans {x0:g} to"
            f" {x1:g} and {y0:g} to {y1:g}."
        )
    return area


def walls_of(area: "BaseGeometry") -> Iterator[Wall]:
    """Yield walls along the outlines of an area; its holes are filled, and lines are walls."""
    import shapely

    for part in getattr(area, "geoms", [area]):
        if hasattr(part, "geoms"):
            yield from walls_of(part)
        elif part.geom_type == "Polygon":
            part = shapely.make_valid(part.simplify(_FINE)) if not part.is_valid else part
            if part.geom_type != "Polygon":
                yield from walls_of(part)
                continue
            yield from _lines(np.array(part.exterior.simplify(_FINE).coords)[:, :2])
            for hole in part.interiors:
                points = _distinct(np.array(hole.simplify(_FINE).coords)[:-1, :2])
                if 3 <= len(points) <= _MOST:
                    yield {"shape": {"type": "polygon", "points": points.tolist()}}
                else:
                    yield from _lines(np.array(hole.coords)[:, :2])
        elif part.geom_type in ("LineString", "LinearRing"):
            yield from _lines(np.array(part.coords)[:, :2])


def _lines(points: FloatArray) -> Iterator[Wall]:
    """Yield a straight wall without thickness between successive points (N, 2).

    The area of a longer line would not be exactly zero, but a rounding error.
    """
    for a, b in pairwise(_distinct(points).tolist()):
        yield {"shape": {"type": "polyline", "points": [[*a], [*b]]}}


def _distinct(points: FloatArray) -> FloatArray:
    """Return the points without those that equal the one before."""
    new = np.ones(len(points), np.bool_)
    new[1:] = (points[1:] != points[:-1]).any(axis=1)
    distinct: FloatArray = points[new]
    return distinct


def ros_map_of(
    image: Path, cell: float | None, origin: tuple[float, float] | None, negate: bool, folder: Path
) -> Path:
    """Write the YAML file of a ROS map for an image into ``folder``, and return its path.

    Args:
        image: a picture, in which free space is light.
        cell: metres per pixel.
        origin: of the image's lower left corner [m].
        negate: whether free space is dark instead.
        folder: temporary.

    Raises UsageError if the cell or the origin is missing.
    """
    import yaml

    if cell is None or origin is None:
        raise UsageError(
            f"The image {image} needs the options 'wall-cell', its metres per pixel, and"
            " 'wall-origin', the place of its lower left corner."
        )
    if not 0.0 < cell <= 1e4 or not max(map(abs, origin)) <= FAR:
        raise UsageError("The metres per pixel must be > 0, and the origin two numbers [m].")
    fields = {
        "image": str(image.resolve()), "resolution": cell, "origin": [*origin, 0.0],
        "negate": int(negate), "occupied_thresh": 0.65, "free_thresh": 0.196,
    }  # fmt: skip
    path = folder / f"{image.stem}.yaml"
    path.write_text(yaml.safe_dump(fields, sort_keys=False, default_flow_style=None))
    return path


def is_image(path: Path) -> bool:
    """Whether a file is an image, by its suffix."""
    return path.suffix.lower() in _IMAGES
