"""Drafts of scenarios among imported obstacles: bounds, starts and goals."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchnav.arrays import Extent
from benchnav.config.document import shown
from benchnav.errors import UsageError, WorldFileError
from benchnav.scenario.importers.draft import (
    Mapping,
    Remark,
    demand_sane,
    drawn_places,
    points,
    scenario_mapping,
    silent,
)
from benchnav.scenario.importers.grid import Occupancy
from benchnav.scenario.importers.plan_view import Piece, walls_of
from benchnav.scenario.importers.room import largest_room
from benchnav.text.plural import counted

RADIUS = 0.2  # [m] default
CELLS = 400  # along the longer side of the grid in which free space is searched
FINEST = 0.05  # [m]
SIDES = (1.0, 2000.0)  # [m] of an arena; others have another unit, most likely
_UNITS = {0.001: "a millimetre", 0.01: "a centimetre", 0.0254: "an inch", 1000.0: "a kilometre"}


@dataclass(frozen=True, kw_only=True)
class WorldOptions:
    """Values that a file of obstacles does not hold."""

    name: str | None = None
    agents: int | None = None  # None: 1 with a start and goal, else up to 20
    radius: float | None = None  # [m]
    bounds: Extent | None = None  # [m]; None: around the obstacles
    margin: float = 1.0  # [m] around the obstacles, starts and goals
    start: tuple[float, float] | None = None  # [m]
    goal: tuple[float, float] | None = None  # [m]
    remark: Remark = silent


def draft_world(
    path: Path,
    name: str,
    pieces: Sequence[Piece],
    options: WorldOptions,
    walls: Sequence[Mapping] | None = None,
    extent: Extent | None = None,
    unit_given: bool = False,
) -> Mapping:
    """Return a scenario among obstacles.

    Args:
        path: the file, for messages.
        name: of the scenario.
        pieces: the obstacles.
        options: what the file does not hold.
        walls: the walls of the scenario; None: those of the pieces.
        extent: of the arena [m], without a margin; None: of the obstacles, with a margin.
        unit_given: whether the user gave the unit, so that any size is meant.

    Raises:
        WorldFileError: the obstacles miss the arena or fill it, or have an unlikely size.
        UsageError: a wrong option.
    """
    import shapely

    demand_sane(options.agents, options.radius, options.name)
    if (options.start is None) != (options.goal is None):
        raise UsageError("A start needs a goal, and a goal a start. Got one of them.")
    area = shapely.union_all([piece.area for piece in pieces])
    own, margin = (extent_of(area), options.margin) if extent is None else (extent, 0.0)
    options.remark(
        f"{counted(len(pieces), 'piece')} of wall; the extent is x = {own[0]:.2f} to"
        f" {own[2]:.2f} m and y = {own[1]:.2f} to {own[3]:.2f} m."
    )
    if options.bounds is None and not unit_given:
        _demand_likely(path, own)
    bounds = options.bounds or _around(own, options, margin)
    _demand_meeting(path, own, area, bounds)
    radius = RADIUS if options.radius is None else options.radius
    places, journey, count = _places(path, area, own, bounds, radius, options)
    if walls is None:
        arena = shapely.box(*bounds)
        walls = walls_of(str(path), [p for p in pieces if p.area.intersects(arena)])
    title = f"{counted(count, 'agent')} in {shown(path.name)}"
    return scenario_mapping(name, title, bounds, True, walls, places, count, radius, journey)


def extent_of(area: Any) -> Extent:
    """Return the box around an area (a shapely geometry)."""
    x0, y0, x1, y1 = area.bounds
    return float(x0), float(y0), float(x1), float(y1)


def _places(
    path: Path, area: Any, extent: Extent, bounds: Extent, radius: float, options: WorldOptions
) -> tuple[Mapping, float, int]:
    """Return starts and goals, the length [m] of a long journey, and the number of agents."""
    if options.start is not None and options.goal is not None:
        _demand_free(path, area, bounds, radius, start=options.start, goal=options.goal)
        if options.agents not in (None, 1):
            raise UsageError(
                f"A start and a goal are those of one agent. Got {options.agents} agents."
            )
        places = {"start": points([options.start]), "goal": points([options.goal])}
        return places, math.dist(options.start, options.goal), 1
    grid = _raster(area, bounds)
    room = largest_room(grid, ~grid.blocked, radius)
    if room is None:
        x0, y0, x1, y1 = extent
        raise WorldFileError(
            f"{path}:1: the arena must have a place for an agent of radius {radius:g} m; the"
            f" obstacles fill it. They are {x1 - x0:.4g} × {y1 - y0:.4g} m large. Check the"
            f" unit, or try a smaller radius.{_likely(extent)}"
        )
    return drawn_places(room, options.agents, options.remark)


def _around(extent: Extent, options: WorldOptions, margin: float) -> Extent:
    spots = np.array([extent[:2], extent[2:]]) + np.array([[-margin], [margin]])
    for spot in (options.start, options.goal):
        if spot is not None:
            around = np.array([np.array(spot) - options.margin, np.array(spot) + options.margin])
            spots = np.vstack([spots, around])
    low, high = np.round(spots.min(axis=0), 3), np.round(spots.max(axis=0), 3)
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def _demand_likely(path: Path, extent: Extent) -> None:
    side = max(extent[2] - extent[0], extent[3] - extent[1])
    if not 0.5 * SIDES[0] <= side <= SIDES[1]:
        raise WorldFileError(
            f"{path}:1: the obstacles must have the size of an arena, {0.5 * SIDES[0]:g} m to"
            f" {SIDES[1]:g} m; they are {extent[2] - extent[0]:.4g} × {extent[3] - extent[1]:.4g} m"
            f" large.{_likely(extent)} The option 'unit' gives it in metres; 1 keeps this size."
        )


def _likely(extent: Extent) -> str:
    """Return the likely unit in a sentence, ""  if the size is likely."""
    side = max(extent[2] - extent[0], extent[3] - extent[1])
    if SIDES[0] <= side <= 300.0:
        return ""
    for unit, name in _UNITS.items():
        if (unit < 1.0) == (side > 1.0) and 2.0 <= side * unit <= 200.0:
            return f" The unit is {name} ({unit:g}) most likely."
    return ""


def _demand_meeting(path: Path, extent: Extent, area: Any, bounds: Extent) -> None:
    """Refuse obstacles that do not meet the arena."""
    import shapely

    if not bounds[0] < bounds[2] or not bounds[1] < bounds[3]:
        raise UsageError(f"bounds must be xmin, ymin, xmax, ymax with min < max. Got {bounds}.")
    arena = shapely.box(*bounds)
    if not area.is_empty and not area.intersects(arena):
        x0, y0, x1, y1 = bounds
        raise WorldFileError(
            f"{path}:1: the obstacles must meet the arena, x = {x0:g} to {x1:g} m and y = {y0:g} to"
            f" {y1:g} m; they lie at x = {extent[0]:.4g} to {extent[2]:.4g} m and y ="
            f" {extent[1]:.4g} to {extent[3]:.4g} m. Check unit and bounds.{_likely(extent)}"
        )


def _demand_free(
    path: Path, area: Any, bounds: Extent, radius: float, **places: tuple[float, float]
) -> None:
    import shapely

    arena = shapely.box(*bounds)
    for name, spot in places.items():
        body = shapely.Point(spot).buffer(radius)
        if not arena.covers(body):
            raise UsageError(
                f"The {name} must lie within the bounds {', '.join(f'{b:g}' for b in bounds)}, a"
                f" radius of {radius:g} m from their edges. Got {spot[0]:g},{spot[1]:g}."
            )
        if body.intersects(area):
            raise UsageError(
                f"The {name} must be free. Got {spot[0]:g},{spot[1]:g}, where an obstacle of"
                f" {path.name} is within {radius:g} m."
            )


def _raster(area: Any, bounds: Extent) -> Occupancy:
    """Return the cells of a grid that obstacles touch."""
    import shapely

    x0, y0, x1, y1 = bounds
    cell = max(FINEST, max(x1 - x0, y1 - y0) / CELLS)
    wide, high = max(1, int((x1 - x0) / cell)), max(1, int((y1 - y0) / cell))
    grown = shapely.buffer(area, 0.71 * cell)  # cells that an obstacle touches
    shapely.prepare(grown)
    x, y = np.meshgrid(x0 + (np.arange(wide) + 0.5) * cell, y0 + (np.arange(high) + 0.5) * cell)
    blocked = np.asarray(shapely.contains_xy(grown, x, y), np.bool_)
    return Occupancy(blocked, np.zeros_like(blocked), cell, (x0, y0, 0.0))
