"""Voronoi density in the measurement area, as PedPy computes it.

Positions are sampled at 1 Hz for every decision step. Walls and static obstacles cut the
cells; thinner ones are made 2 mm thick, so that no cell reaches through a thin wall. As in
Steffen & Seyfried for sparse crowds, cells end at a distance of 0.8 m from their agent, so they
are smaller than about 2 m². Therefore an agent farther than 0.8 m from the area adds nothing,
and an agent farther than three times that bounds no cell that does. Agents and obstacles that
have no influence are left out, and of an agent that only bounds cells, no cell is cut.

PedPy's function takes a table for each frame. Here the same operations of GEOS cut the cells of
all frames at once.
"""

import itertools
import math
from typing import Any

import numpy as np

from benchnav.arena.solid import Solid
from benchnav.arena.world import World
from benchnav.arrays import AnyArray, BoolArray, Extent, FloatArray, IntArray
from benchnav.geometry.capsule import nearest_on_segment
from benchnav.kernels import kernel_without_allocation
from benchnav.metrics.quantities.trajectory import Trajectories, positions_at, present_at
from benchnav.metrics.quantities.voronoi_cells import part_with, voronoi_cells

FRAME_RATE = 2.0  # [Hz] of quantities that are quick to compute
DENSITY_RATE = 1.0  # [Hz]
REACH = 0.8  # [m]: a circle of 2.01 m²
QUARTER = 16  # segments of a quarter of that circle
SKIN = 1e-3  # [m] half the minimum thickness of a wall
CLEAR = 1e-9  # [m] by which a polygon must be within another so that nothing is cut
AWAY = 128.0  # [m] shift of all geometry: GEOS cannot cut cells with corners such as 1e-33


def voronoi_density(world: World, trajectories: Trajectories) -> FloatArray:
    """Return densities (N,) [1/m²] at 1 Hz from the start; (0,) without a measurement area."""
    area = world.measurement_area
    if area is None:
        return np.zeros(0)
    import shapely
    import shapely.affinity

    times = frame_times(trajectories, DENSITY_RATE)
    _, frames, points = bodies_at(trajectories, times)
    density = np.zeros(len(times))
    counts = _relevant(area, frames, points)
    if not counts.any():
        return density
    walkable = _nearby(walkable_area(world), area)
    counts &= shapely.contains_xy(walkable, points[:, 0], points[:, 1])
    if not counts.any():
        return density
    there = shapely.normalize(shapely.affinity.translate(walkable, AWAY, AWAY))
    frames, points = frames[counts], points[counts]
    order = np.argsort(frames, kind="stable")
    frames, points = frames[order], points[order]
    inside = _away(area, points) <= REACH + SKIN
    points += AWAY
    try:
        cells = diagram_cells(frames, points, inside, there)
    except shapely.errors.GEOSException:  # it cannot cut its own Voronoi diagram
        cells = half_plane_cells(frames, points, inside, there)
    box, share = shapely.normalize(shapely.box(*(np.array(area) + AWAY))), np.zeros(len(points))
    measured = common_parts(cells, box, _within_box(cells, box))
    share[inside] = shapely.area(measured) / shapely.area(cells)
    add_shares(frames, share, np.zeros(len(density)), density)
    density /= shapely.area(box)
    return density


def diagram_cells(
    frames: IntArray, points: FloatArray, inside: BoolArray, walkable: Any
) -> AnyArray:
    """Return the cells of the points (N, 2) [m] that are ``inside``, from Voronoi diagrams.

    The points are sorted by their frames. Raises GEOSException if GEOS cannot cut a diagram.
    """
    import shapely

    found = []
    for low, high in _runs(frames):
        if inside[low:high].any():
            seen = shapely.multipoints(points[low:high])
            diagram = shapely.voronoi_polygons(seen, extend_to=walkable, ordered=True)
            found.append(shapely.get_parts(diagram)[inside[low:high]])
    centers = points[inside]
    circle = shapely.get_coordinates(shapely.Point(0.0, 0.0).buffer(REACH, quad_segs=QUARTER))
    shapely.prepare(walkable)
    cells = np.concatenate(found)
    cells = common_parts(cells, walkable, shapely.contains_properly(walkable, cells))
    circles = shapely.polygons(centers[:, None] + circle)
    within, around = _sizes(cells, centers)
    circles[around] = turned(circles[around])
    circles[~around] = common_parts(cells[~around], circles[~around], within[~around])
    cells = circles
    for n in np.flatnonzero(shapely.get_type_id(cells) != shapely.GeometryType.POLYGON):
        cells[n] = part_with(centers[n], cells[n])
    return np.asarray(cells)


def common_parts(cells: AnyArray, areas: Any, within: BoolArray) -> AnyArray:
    """Return ``shapely.intersection(cells, areas)``, where some cells are ``within`` their area.

    GEOS then returns the same ring, but from its second corner on, so that the last bits of its
    area differ. This function does the same without a search for crossings.
    """
    import shapely

    found = np.empty(len(cells), object)
    others = areas[~within] if isinstance(areas, np.ndarray) else areas
    found[within] = turned(cells[within])
    found[~within] = shapely.intersection(cells[~within], others)
    return found


def turned(polygons: AnyArray) -> AnyArray:
    """Return polygons without holes, whose rings begin with the second corner."""
    import shapely

    if len(polygons) == 0:
        return polygons
    points, owner = shapely.get_coordinates(polygons, return_index=True)
    first = np.searchsorted(owner, np.arange(len(polygons) + 1))
    size = np.diff(first)[owner] - 1  # without the repeated first corner
    place = first[owner] + (np.arange(len(owner)) - first[owner] + 1) % size
    return np.asarray(shapely.polygons(shapely.linearrings(points[place], indices=owner)))


def _sizes(cells: AnyArray, centers: FloatArray) -> tuple[BoolArray, BoolArray]:
    """Return which cells are certainly within the circle around their center (N, 2) [m], and
    which certainly contain it. The circle is a polygon with corners at `REACH`.
    """
    import shapely

    simple = _is_simple(cells)
    within, around = np.zeros(len(cells), np.bool_), np.zeros(len(cells), np.bool_)
    points, owner = shapely.get_coordinates(cells[simple], return_index=True)
    far, near = np.zeros(len(cells)), np.full(len(cells), np.inf)
    write_sizes(points, np.flatnonzero(simple)[owner], centers, far, near)
    within[simple] = far[simple] < REACH * math.cos(0.25 * math.pi / QUARTER) - CLEAR
    around[simple] = near[simple] > REACH + CLEAR
    return within, around


@kernel_without_allocation
def write_sizes(
    points: FloatArray, owner: IntArray, centers: FloatArray, far: FloatArray, near: FloatArray
) -> None:
    """Write the distances (N,) [m] from centers (N, 2) to the farthest and nearest point of rings.

    Corner k (P, 2) belongs to the closed ring ``owner[k]``, whose corners are consecutive.
    """
    for k in range(len(points)):
        n = owner[k]
        x, y = points[k, 0] - centers[n, 0], points[k, 1] - centers[n, 1]
        far[n] = max(far[n], math.sqrt(x * x + y * y))
        if k > 0 and owner[k - 1] == n:
            bx, by = points[k - 1, 0] - centers[n, 0], points[k - 1, 1] - centers[n, 1]
            qx, qy = nearest_on_segment(0.0, 0.0, x, y, bx, by)
            near[n] = min(near[n], math.sqrt(qx * qx + qy * qy))


def _within_box(cells: AnyArray, box: Any) -> BoolArray:
    import shapely

    bounds, (x0, y0, x1, y1) = shapely.bounds(cells), box.bounds
    inside: BoolArray = (bounds[:, :2] > (x0, y0)).all(axis=1)
    inside &= (bounds[:, 2:] < (x1, y1)).all(axis=1)
    return inside & _is_simple(cells)


def _is_simple(cells: AnyArray) -> BoolArray:
    """Whether each of the cells (N,) is a polygon without holes."""
    import shapely

    simple: BoolArray = shapely.get_type_id(cells) == shapely.GeometryType.POLYGON
    simple &= shapely.get_num_interior_rings(cells) == 0
    return simple


def half_plane_cells(
    frames: IntArray, points: FloatArray, inside: BoolArray, walkable: Any
) -> AnyArray:
    """Return the same cells, from `voronoi_cells`."""
    cells: list[Any] = []
    for low, high in _runs(frames):
        cells += voronoi_cells(points[low:high], walkable, REACH, QUARTER)
    return np.array(cells, dtype=object)[inside]


def _runs(frames: IntArray) -> "itertools.pairwise[tuple[int, int]]":
    """Return the first point of each frame, and that after its last, of sorted frames (N,)."""
    begins = np.flatnonzero(np.diff(frames, prepend=-1)).tolist()
    return itertools.pairwise([*begins, len(frames)])


@kernel_without_allocation
def add_shares(frames: IntArray, share: FloatArray, error: FloatArray, total: FloatArray) -> None:
    """Add the shares (N,) of each frame to ``total`` (F,) with Kahan's sum, as pandas does.

    ``error`` (F,) is scratch and begins with zeros.
    """
    for n in range(len(frames)):
        f = frames[n]
        part = share[n] - error[f]
        more = total[f] + part
        error[f] = more - total[f] - part
        total[f] = more


def _relevant(area: Extent, frames: IntArray, points: FloatArray) -> BoolArray:
    """Return the mask (N,) of points that can change the density."""
    away = _away(area, points)
    busy = np.zeros(int(frames.max(initial=0)) + 1, dtype=np.bool_)
    busy[frames[away <= REACH]] = True
    relevant: BoolArray = busy[frames] & (away <= 3.0 * REACH)
    return relevant


def _away(area: Extent, points: FloatArray) -> FloatArray:
    """Return the distances (N,) [m] of points (N, 2) from a rectangle."""
    beyond = np.maximum(np.maximum(area[:2] - points, points - area[2:]), 0.0)
    return np.hypot(beyond[:, 0], beyond[:, 1])


def _nearby(walkable: Any, area: Extent) -> Any:
    """Return the part of the walkable area that the cells of relevant agents can reach."""
    import shapely

    x0, y0, x1, y1 = area
    margin = 4.0 * REACH
    near = shapely.box(x0 - margin, y0 - margin, x1 + margin, y1 + margin).intersection(walkable)
    return near if near.geom_type == "Polygon" else walkable


def frame_times(trajectories: Trajectories, rate: float = FRAME_RATE) -> FloatArray:
    """Return the times (N,) [s] at ``rate`` [Hz], to the end of the record."""
    record = trajectories.duration.shape[1] * trajectories.dt
    return np.arange(int(record * rate + 1e-9) + 1) / rate


def bodies_at(
    trajectories: Trajectories, times: FloatArray
) -> tuple[IntArray, IntArray, FloatArray]:
    """Return agent (N,), frame (N,) and place (N, 2) [m] of all agents present at ``times``."""
    ids, frames = np.nonzero(present_at(trajectories, times))
    return ids, frames, positions_at(trajectories, times)[ids, frames]


def walkable_area(world: World) -> Any:
    """Return the free part of the bounds that contains most of the measurement area."""
    import shapely

    free = shapely.box(*world.bounds)
    for solid in world.solids:
        free = _without(free, solid)
    measured = shapely.box(*world.measurement_area or world.bounds)
    parts = [part for part in shapely.get_parts(free) if part.geom_type == "Polygon"]
    if not parts:
        return shapely.Polygon()
    return max(parts, key=lambda part: (part.intersection(measured).area, part.area))


def _without(free: Any, solid: Solid) -> Any:
    """Return ``free`` without a solid; counter-clockwise loops are filled, others hollow."""
    import shapely

    if solid.is_disc:
        return free.difference(shapely.Point(solid.center).buffer(solid.radius))
    filled: list[Any] = []
    hollow: list[Any] = []
    for loop in solid.loops:
        shape = shapely.make_valid(shapely.Polygon(loop)) if len(loop) > 2 else None
        if shape is not None and shape.area > 0.0:
            (filled if shapely.LinearRing(loop).is_ccw else hollow).append(shape)
    rims = [shapely.LineString(np.vstack([loop, loop[:1]])) for loop in solid.loops]
    skin = shapely.union_all([rim.buffer(SKIN) for rim in rims])
    hole = shapely.union_all(hollow)
    if filled:
        return free.difference(shapely.union_all(filled).difference(hole).union(skin))
    return (free.intersection(hole) if hollow else free).difference(skin)
