"""Shapes in the plane as walls of a scenario: discs, boxes and polygons without holes."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchnav.errors import WorldFileError

MAX_CORNERS = 900  # of a polygon; the scenario allows 1000
MAX_PLACES = 900  # of equal discs in one wall
MAX_PIECES = 2000
GRID = 1e-6  # [m] of the corners of polygons
SMALLEST = 1e-6  # [m²] smaller pieces are left out


@dataclass(frozen=True, eq=False)
class Piece:
    """An obstacle: a wall of the scenario, and its area (a shapely geometry)."""

    wall: dict[str, Any]
    area: Any


def disc(x: float, y: float, radius: float) -> Piece:
    """Return a disc."""
    import shapely

    wall = {"shape": {"type": "disc", "radius": _round(radius)}, "at": [_round(x), _round(y)]}
    return Piece(wall, shapely.Point(x, y).buffer(radius, quad_segs=16))


def box(x: float, y: float, width: float, depth: float, heading: float) -> Piece:
    """Return a rectangle around (x, y), turned by ``heading`` [rad]."""
    import shapely
    import shapely.affinity

    wall: dict[str, Any] = {
        "shape": {"type": "box", "width": _round(width), "depth": _round(depth)},
        "at": [_round(x), _round(y)],
    }
    if abs(heading) > 1e-9:
        wall["heading"] = _round(math.remainder(heading, 2.0 * math.pi))
    area = shapely.box(-0.5 * width, -0.5 * depth, 0.5 * width, 0.5 * depth)
    area = shapely.affinity.rotate(area, heading, origin=(0.0, 0.0), use_radians=True)
    return Piece(wall, shapely.affinity.translate(area, x, y))


def polygons(area: Any) -> Iterator[Piece]:
    """Yield polygons without holes that cover an area (a shapely geometry)."""
    import shapely

    for part in shapely.get_parts(shapely.set_precision(area, GRID)):
        if part.geom_type != "Polygon" or part.area <= SMALLEST:
            continue
        if len(part.interiors) or len(part.exterior.coords) > MAX_CORNERS:
            yield from polygons(_halves(part))
            continue
        corners = np.round(np.asarray(part.exterior.coords)[:-1, :2], 6)
        yield Piece({"shape": {"type": "polygon", "points": corners.tolist()}}, part)


def _halves(part: Any) -> Any:
    """Return a polygon cut in two: through its first hole, or else in the middle."""
    import shapely

    x0, y0, x1, y1 = part.bounds
    across = len(part.interiors) > 0 or x1 - x0 >= y1 - y0
    if len(part.interiors):
        low, _, high, _ = part.interiors[0].bounds
        middle = 0.5 * (low + high)
    else:
        middle = 0.5 * (x0 + x1) if across else 0.5 * (y0 + y1)
    if across:
        boxes = shapely.box(x0, y0, middle, y1), shapely.box(middle, y0, x1, y1)
    else:
        boxes = shapely.box(x0, y0, x1, middle), shapely.box(x0, middle, x1, y1)
    return shapely.GeometryCollection(
        [p for b in boxes for p in shapely.get_parts(shapely.intersection(part, b))]
    )


def walls_of(where: str, pieces: Sequence[Piece]) -> list[dict[str, Any]]:
    """Return the walls of a scenario; equal discs are one wall at several places.

    Raises WorldFileError for more pieces than a scenario may have.
    """
    if len(pieces) > MAX_PIECES:
        raise WorldFileError(
            f"{where}: a scenario has at most {MAX_PIECES} pieces of wall; the file has"
            f" {len(pieces)}. Simplify it, or cut it by the option 'bounds'."
        )
    found: list[dict[str, Any]] = []
    places: dict[float, list[list[float]]] = {}
    for piece in pieces:
        shape = piece.wall["shape"]
        if shape["type"] == "disc":
            places.setdefault(shape["radius"], []).append(piece.wall["at"])
        else:
            found.append(piece.wall)
    for radius, own in places.items():
        for first in range(0, len(own), MAX_PLACES):
            some = own[first : first + MAX_PLACES]
            at = some[0] if len(some) == 1 else some
            found.append({"shape": {"type": "disc", "radius": radius}, "at": at})
    return found


def _round(number: float) -> float:
    return round(float(number), 6) + 0.0
