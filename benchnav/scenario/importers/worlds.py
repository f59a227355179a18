"""Scenarios from SDF worlds, meshes and WKT geometries."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchnav.config.document import shown
from benchnav.errors import WorldFileError
from benchnav.scenario.files.mesh_file import Up
from benchnav.scenario.files.mesh_section import mesh_solids
from benchnav.scenario.importers.draft import Mapping, default_name
from benchnav.scenario.importers.plan_view import Piece, polygons
from benchnav.scenario.importers.sdf import SdfOptions, read_sdf
from benchnav.scenario.importers.world_draft import WorldOptions, draft_world, extent_of
from benchnav.scenario.importers.xml_tree import bytes_of

MAX_CORNERS = 500_000  # of a WKT geometry
LARGEST = 1e9  # coordinate of a WKT geometry, in its unit
_WKT = ("POLYGON", "MULTIPOLYGON", "GEOMETRYCOLLECTION")


def import_sdf(path: Path, options: WorldOptions, sdf: SdfOptions) -> Mapping:
    """Return a scenario among the obstacles of an SDF world or model."""
    world = read_sdf(path, sdf)
    for text in dict.fromkeys(world.remarks):
        options.remark(text)
    name = options.name or default_name("sdf", path)
    return draft_world(path, name, world.pieces, options)


def import_mesh(
    path: Path,
    options: WorldOptions,
    *,
    unit: float | None,
    up: Up | None,
    scale: Sequence[float],
    band: tuple[float, float],
) -> Mapping:
    """Return a scenario around the part of a mesh within the agents' band of heights."""
    solids, _ = mesh_solids(path, unit, up, scale, band)
    pieces = [Piece({"shape": {"type": "mesh"}}, _area(solid.loops)) for solid in solids]
    shape: dict[str, Any] = {"type": "mesh", "file": str(path.resolve())}
    shape |= {} if unit is None else {"unit": unit}
    shape |= {} if up is None else {"up": up}
    shape |= {} if tuple(scale) == (1.0, 1.0, 1.0) else {"scale": list(scale)}
    shape["band"] = list(band)
    name = options.name or default_name("mesh", path)
    walls = [{"shape": shape}]
    return draft_world(path, name, pieces, options, walls, unit_given=unit is not None)


def import_wkt(path: Path, options: WorldOptions, *, unit: float, obstacles: bool) -> Mapping:
    """Return a scenario in a walkable area, or among obstacles, written as WKT.

    Holes of a walkable area are obstacles, as in JuPedSim and PedPy.

    Raises WorldFileError with the place.
    """
    import shapely
    import shapely.affinity

    area = shapely.affinity.scale(_read_wkt(path), unit, unit, origin=(0.0, 0.0))
    name = options.name or default_name("wkt", path)
    given = unit != 1.0
    if obstacles:
        return draft_world(path, name, list(polygons(area)), options, unit_given=given)
    outside = shapely.difference(shapely.box(*area.bounds), area)
    pieces = list(polygons(outside))
    return draft_world(path, name, pieces, options, extent=extent_of(area), unit_given=given)


def _area(loops: Sequence[Any]) -> Any:
    import shapely

    return shapely.Polygon(loops[0], list(loops[1:]))


def _read_wkt(path: Path) -> Any:
    """Return the polygons of a WKT file."""
    import shapely

    raw = bytes_of(path, "the geometry")
    try:
        text = raw.decode("utf-8-sig").strip()
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise WorldFileError(f"{path}:{line}: the text must be encoded in UTF-8.") from None
    head = text[:40].upper()
    if not head.startswith(_WKT):
        raise WorldFileError(
            f"{path}:1: the geometry must begin with {', '.join(_WKT)}; got"
            f" {shown(text[:30]) if text else 'an empty file'!r}."
        )
    if text.count(",") > MAX_CORNERS:
        raise WorldFileError(f"{path}:1: a geometry has at most {MAX_CORNERS} corners.")
    try:
        with np.errstate(all="ignore"):  # coordinates are tested below
            found = shapely.from_wkt(text)
    except (shapely.errors.ShapelyError, ValueError, RecursionError) as error:
        reason = " ".join(str(error).split())[:120].rstrip(".")
        raise WorldFileError(f"{path}:1: the file must be WKT; {reason}.") from None
    parts = [p for p in shapely.get_parts(found) if p.geom_type in ("Polygon", "MultiPolygon")]
    flat = [p for part in parts for p in shapely.get_parts(part)]
    _demand_valid(path, flat)
    if not any(part.area > 0.0 for part in flat):
        raise WorldFileError(f"{path}:1: the geometry must have a polygon; it has none.")
    return shapely.union_all(shapely.force_2d(flat))


def _demand_valid(path: Path, flat: Sequence[Any]) -> None:
    """Refuse polygons with coordinates that are too large, or that cross themselves."""
    import shapely

    for number, part in enumerate(flat, 1):
        if not (np.abs(shapely.get_coordinates(part)) <= LARGEST).all():
            raise WorldFileError(
                f"{path}:1: polygon {number} must have coordinates up to {LARGEST:g}."
            )
        if not part.is_valid:
            raise WorldFileError(
                f"{path}:1: polygon {number} must not cross itself; {_invalid(part)}."
            )


def _invalid(part: Any) -> str:
    import shapely

    return str(shapely.is_valid_reason(part)).lower()
