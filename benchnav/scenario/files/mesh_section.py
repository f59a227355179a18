"""A mesh as a planar obstacle: its part within the agents' height band."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchnav.arena.mesh import Mesh
from benchnav.arena.solid import Kind, Solid
from benchnav.arrays import AnyArray, FloatArray, IntArray
from benchnav.errors import MeshError
from benchnav.scenario.files.mesh_file import Up, merged, place, read_triangles

SIMPLIFY = 1e-3  # [m] tolerance of simplified outlines
THIN = 2e-3  # [m] thickness of a sheet without volume
_GRID = 1e-6  # [m] grid of rounded unions
_SPECK = 1e-8  # [m²] smaller polygons and holes are dropped


def mesh_solids(
    path: Path | str,
    unit: float | None,
    up: Up | None,
    scale: float | Sequence[float],
    band: tuple[float, float],
    yaw: float = 0.0,
    at: Sequence[float] = (0.0, 0.0),
    kind: Kind = Kind.STATIC,
) -> tuple[tuple[Solid, ...], Mesh]:
    """Return the outlines of the part of a mesh between two heights, and the placed mesh.

    The obstacle is the union of the plan views of all parts strictly within the
    band. Closed outlines are filled, each connected part of the mesh separately, by
    the even-odd rule: a pipe stays hollow, a hull is solid. A sheet that encloses
    no area becomes a wall of thickness ``THIN``. Outlines are exact to ``SIMPLIFY``.

    Args:
        path: a COLLADA, STL, OBJ, PLY or OFF file.
        unit: [m] of the file's unit; None: as the file declares, else 1.
        up: the file's axis that points up; None: as the file declares, else z.
        scale: factor, or one for each of the file's axes, applied before `up`.
        band: (low, high) [m] heights above the arena's floor.
        yaw: rotation of the mesh [rad].
        at: (x, y) or (x, y, z) [m] of its origin.
        kind: of the solids.

    Raises:
        MeshError: not a mesh, or no part of it lies within the band.
        MissingExtraError: trimesh or pycollada is not installed.
    """
    path = Path(path)
    vertices, faces, own_unit, own_up = read_triangles(path)
    placed = place(vertices, unit or own_unit, up or own_up, scale, yaw, at)
    placed, faces = merged(placed, faces)
    region = section(placed, faces, band)
    loops = [_loops(part) for part in _parts(region)]
    if not loops:
        low, high = placed[:, 2].min(), placed[:, 2].max()
        raise MeshError(
            f"{path}:1: the mesh must have a part between {band[0]} m and {band[1]} m; "
            f"it spans {low:.4g} m to {high:.4g} m. Check unit, up, scale and band."
        )
    return tuple(Solid(kind, part) for part in loops), Mesh(placed, faces, band)


def section(vertices: FloatArray, faces: IntArray, band: tuple[float, float]) -> Any:
    """Return the plan view (a shapely geometry) of the part within a height band (low, high) [m].

    ``vertices`` (V, 3) [m], z up, no two equal; ``faces`` (F, 3).
    """
    import shapely

    low, high = band
    heights = vertices[faces][..., 2]
    within = faces[(heights.max(axis=1) > low) & (heights.min(axis=1) < high)]
    if len(within) == 0:
        return shapely.Polygon()
    areas, lines = _plan_views(vertices[within], low, high)
    filled = [_filled(vertices, part, band) for part in _components(faces)]
    region = shapely.union_all([*areas, *filled], grid_size=_GRID)
    sheets = shapely.difference(shapely.union_all(lines), shapely.buffer(region, 2.0 * _GRID))
    if not sheets.is_empty:
        walls = shapely.buffer(sheets, THIN / 2.0, cap_style="square", join_style="mitre")
        region = shapely.union_all([region, walls], grid_size=_GRID)
    return shapely.simplify(region, SIMPLIFY, preserve_topology=True)


def _plan_views(corners: FloatArray, low: float, high: float) -> tuple[list[Any], list[Any]]:
    """Return polygons and lines (of upright triangles) of triangles (F, 3, 3) clipped to the band.

    A clipped triangle is convex, so its plan view is the hull of the corners within
    the band and of the points where its edges leave the band.
    """
    import shapely

    z = corners[..., 2]
    owner, points = [], []
    face, corner = np.nonzero((z >= low) & (z <= high))
    owner.append(face)
    points.append(corners[face, corner, :2])
    after = np.roll(corners, -1, axis=1)
    for level in (low, high):
        face, edge = np.nonzero((z - level) * (after[..., 2] - level) < 0.0)
        owner.append(face)
        points.append(_cut(corners[face, edge], after[face, edge], level))
    index = np.concatenate(owner)
    order = np.argsort(index, kind="stable")
    used, index = np.unique(index[order], return_inverse=True)
    spots = shapely.multipoints(np.concatenate(points)[order], indices=index, out=None)
    hulls: AnyArray = shapely.convex_hull(spots[: len(used)])
    flat = shapely.area(hulls) <= _GRID * shapely.length(hulls)
    lines = [h for h in hulls[flat] if h.length > 0.0]
    return list(hulls[~flat]), [h.boundary if h.geom_type == "Polygon" else h for h in lines]


def _cut(a: FloatArray, b: FloatArray, level: float) -> FloatArray:
    """Return the points (N, 2) where segments a–b (N, 3) cross a height, equal from either end."""
    swap = (a[:, 2] > b[:, 2])[:, None]
    below, above = np.where(swap, b, a), np.where(swap, a, b)
    share = (level - below[:, 2]) / (above[:, 2] - below[:, 2])
    plan: FloatArray = below[:, :2] + share[:, None] * (above[:, :2] - below[:, :2])
    return plan


def _components(faces: IntArray) -> list[IntArray]:
    """Return groups of faces that are connected through shared vertices."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    size = int(faces.max()) + 1
    ends = np.concatenate([faces[:, :2], faces[:, 1:]])
    graph = coo_array((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(size, size))
    label = connected_components(graph, directed=False)[1][faces[:, 0]]
    order = np.argsort(label, kind="stable")
    return np.split(faces[order], np.flatnonzero(np.diff(label[order])) + 1)


def _filled(vertices: FloatArray, faces: IntArray, band: tuple[float, float]) -> Any:
    """Return the area that one connected part encloses at a height without vertices in the band.

    Everything inside the mesh throughout the band is inside at that height too; the
    rest of the obstacle is the plan view of the surface.
    """
    import shapely

    z = np.clip(vertices[faces].reshape(-1, 3)[:, 2], *band)
    levels = np.unique(np.concatenate([z, band]))
    widest = int(np.argmax(np.diff(levels)))
    level = 0.5 * (levels[widest] + levels[widest + 1])
    corners = vertices[faces]
    after = np.roll(corners, -1, axis=1)
    crosses = (corners[..., 2] > level) != (after[..., 2] > level)
    face, edge = np.nonzero(crosses)  # the two edges of each crossing face are adjacent
    points = _cut(corners[face, edge], after[face, edge], level)
    lines = shapely.linestrings(points.reshape(-1, 2, 2))
    return shapely.build_area(shapely.union_all(lines))


def _parts(region: Any) -> list[Any]:
    import shapely

    return [
        part
        for part in shapely.get_parts(region)
        if part.geom_type == "Polygon" and part.area > _SPECK
    ]


def _loops(polygon: Any) -> tuple[FloatArray, ...]:
    """Return the outer boundary counter-clockwise, holes clockwise, without repeated vertices."""
    import shapely

    holes = [r for r in polygon.interiors if shapely.Polygon(r).area > _SPECK]
    turned = shapely.orient_polygons(shapely.Polygon(polygon.exterior, holes), exterior_cw=False)
    rings = [turned.exterior, *turned.interiors]
    return tuple(np.asarray(ring.coords, np.float64)[:-1, :2].copy() for ring in rings)
