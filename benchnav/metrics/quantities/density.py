"""Voronoi density in the measurement area, computed with PedPy.

Positions are sampled at 1 Hz for every decision step. Walls and static obstacles cut the
cells; thinner ones are made 2 mm thick, so that no cell reaches through a thin wall. As in
Steffen & Seyfried for sparse crowds, cells end at a distance of 0.8 m from their agent, so they
are smaller than about 2 m². Therefore an agent farther than 0.8 m from the area adds nothing,
and an agent farther than three times that bounds no cell that does. Agents and obstacles that
have no influence are left out.
"""

from typing import Any

import numpy as np

from benchnav.arena.solid import Solid
from benchnav.arena.world import World
from benchnav.arrays import BoolArray, Extent, FloatArray, IntArray
from benchnav.metrics.quantities.trajectory import Trajectories, positions_at, present_at
from benchnav.metrics.quantities.voronoi_cells import voronoi_cells

FRAME_RATE = 2.0  # [Hz] of quantities that are quick to compute
DENSITY_RATE = 1.0  # [Hz]
REACH = 0.8  # [m]: a circle of 2.01 m²
QUARTER = 16  # segments of a quarter of that circle
SKIN = 1e-3  # [m] half the minimum thickness of a wall
AWAY = 128.0  # [m] shift of all geometry: GEOS cannot cut cells with corners such as 1e-33


def voronoi_density(world: World, trajectories: Trajectories) -> FloatArray:
    """Return densities (N,) [1/m²] at 1 Hz from the start; (0,) without a measurement area."""
    area = world.measurement_area
    if area is None:
        return np.zeros(0)
    import shapely
    import shapely.affinity

    times = frame_times(trajectories, DENSITY_RATE)
    ids, frames, points = bodies_at(trajectories, times)
    density = np.zeros(len(times))
    counts = _relevant(area, frames, points)
    if not counts.any():
        return density
    walkable = _nearby(walkable_area(world), area)
    counts &= shapely.contains_xy(walkable, points[:, 0], points[:, 1])
    if not counts.any():
        return density
    there = shapely.affinity.translate(walkable, AWAY, AWAY)
    table = _table(ids[counts], frames[counts], points[counts] + AWAY)
    box = shapely.box(*(np.array(area) + AWAY))
    try:
        measured = _measured(_pedpys_cells(table, there), box)
    except shapely.errors.GEOSException:
        measured = _measured(_own_cells(table, there), box)
    density[measured["frame"].to_numpy()] = measured["density"].to_numpy()
    return density


def _measured(cells: Any, box: Any) -> Any:
    """Return a table of densities, with one row for each frame."""
    import pedpy

    found, _ = pedpy.compute_voronoi_density(
        individual_voronoi_data=cells, measurement_area=pedpy.MeasurementArea(box)
    )
    return found


def _pedpys_cells(table: Any, walkable: Any) -> Any:
    """Return PedPy's cells. Raises GEOSException if GEOS cannot cut its own Voronoi diagram."""
    import pedpy

    return pedpy.compute_individual_voronoi_polygons(
        traj_data=table,
        walkable_area=pedpy.WalkableArea(walkable),
        cut_off=pedpy.Cutoff(radius=REACH, quad_segments=QUARTER),
    )


def _own_cells(table: Any, walkable: Any) -> Any:
    """Return the cells of `voronoi_cells`, as PedPy returns its own."""
    import pandas as pd

    found = []
    for _, rows in table.data.groupby("frame"):
        cells = voronoi_cells(rows[["x", "y"]].to_numpy(), walkable, REACH, QUARTER)
        density = [1.0 / cell.area for cell in cells]
        found.append(rows[["id", "frame"]].assign(polygon=cells, density=density))
    return pd.concat(found, ignore_index=True)


def _relevant(area: Extent, frames: IntArray, points: FloatArray) -> BoolArray:
    """Return the mask (N,) of points that can change the density."""
    beyond = np.maximum(np.maximum(area[:2] - points, points - area[2:]), 0.0)
    away = np.hypot(beyond[:, 0], beyond[:, 1])
    busy = np.zeros(int(frames.max(initial=0)) + 1, dtype=np.bool_)
    busy[frames[away <= REACH]] = True
    relevant: BoolArray = busy[frames] & (away <= 3.0 * REACH)
    return relevant


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


def _table(ids: IntArray, frames: IntArray, points: FloatArray) -> Any:
    import pandas as pd
    import pedpy

    columns = {"id": ids, "frame": frames, "x": points[:, 0], "y": points[:, 1]}
    return pedpy.TrajectoryData(data=pd.DataFrame(columns), frame_rate=DENSITY_RATE)
