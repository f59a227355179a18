"""Drafts of scenarios on imported maps, as mappings with the keys of a scenario file."""

import math
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from benchnav.arrays import Extent, FloatArray
from benchnav.config.document import shown
from benchnav.errors import MapError, UsageError
from benchnav.scenario.base import MAX_NAME, NAME_PATTERN
from benchnav.scenario.importers import journeys, movingai, ros_map
from benchnav.scenario.importers.grid import Occupancy, demand_free
from benchnav.scenario.importers.room import Room, largest_room

Mapping = dict[str, Any]
Remark = Callable[[str], None]

_MAX_AGENTS = 20  # default
_RADII = tuple(0.2 / 2**k for k in range(6))  # [m]
_SPEED = 1.0  # [m/s]
_MIN_SHARE = 0.25  # least distance of start and goal, as a share of the area's smaller side
_PATIENCE = 3.0  # ratio of the horizon to the time of an undisturbed journey
_MOSTLY = 0.95  # a share of blocked cells that is rare among maps
_COMMON = {"", "map", "maps", "out", "s", "scenario", "scenarios"}  # names shared by many maps


def silent(text: str) -> None:
    """Ignore a remark."""


def import_movingai(
    map_path: Path | str,
    scen_path: Path | str | None = None,
    *,
    agents: int | None = None,
    bucket: int | None = None,
    cell: float = 1.0,
    radius: float | None = None,
    name: str | None = None,
    remark: Remark = silent,
) -> Mapping:
    """Return a scenario on a MovingAI map.

    With a ``.scen`` file, starts and goals are those of its rows, spread over the
    buckets, without repeated starts or goals; otherwise they are drawn as on a
    map_server map.

    Args:
        map_path: a ``.map`` file.
        scen_path: a ``.scen`` file of that map.
        agents: number of agents; None: up to 20, as far as space or rows allow.
        bucket: takes only the first rows of this bucket.
        cell: side of a cell [m].
        radius: of an agent [m]; None: 0.3 cells.
        name: of the scenario; None: ``movingai/`` and the name of the map.
        remark: called with each remark about the map and the journeys.

    Raises:
        MapError: a file is wrong or has too few rows, or no agent fits.
        UsageError: a bucket without a ``.scen`` file, or no agents, or no radius.
    """
    demand_sane(agents, radius, name)
    path = Path(map_path)
    occupancy = movingai.read_map(path, cell)
    demand_free(f"{path}:1", occupancy, False, "")
    _remark_cells(occupancy, False, remark)
    size = 0.3 * cell if radius is None else radius
    shape = {"type": "occupancy", "file": str(path.resolve()), "format": "movingai", "cell": cell}
    called = name or default_name("movingai", path)
    if scen_path is None:
        if bucket is not None:
            raise UsageError(f"A bucket needs a .scen file; got bucket {bucket} without one.")
        room = _room(path, occupancy, False, (size,))
        places, journey, count = drawn_places(room, agents, remark)
        return _scenario(called, path, shape, occupancy, places, count, size, journey)
    queries = movingai.read_scen(scen_path, path, occupancy)
    rows = _rows(Path(scen_path), queries, agents, bucket, remark)
    places = {
        "start": points(occupancy.centres(*queries.start[rows].T)),
        "goal": points(occupancy.centres(*queries.goal[rows].T)),
    }
    lengths = queries.length[rows] * cell
    remark(journeys.summary(lengths))
    journey = float(lengths.max())
    return _scenario(called, path, shape, occupancy, places, len(rows), size, journey)


def import_ros_map(
    path: Path | str,
    *,
    agents: int | None = None,
    radius: float | None = None,
    unknown_is_free: bool = False,
    name: str | None = None,
    remark: Remark = silent,
) -> Mapping:
    """Return a scenario on a map_server map.

    Starts and goals are drawn in the largest connected part of the map where agents fit,
    goals at least a quarter of its smaller side away.

    Args:
        path: the map's YAML file.
        agents: number of agents; None: 20, or as many as fit.
        radius: of an agent [m]; None: 0.2 m, or half of it, a quarter, … until two agents fit.
        unknown_is_free: whether agents may enter cells that are unknown in the map.
        name: of the scenario; None: ``ros/`` and the name of the map, or of its folder
            if the map is called ``map``.
        remark: called with each remark about the map and the journeys.

    Raises:
        MapError: the file is wrong, or no agent fits.
        UsageError: no agents, or no radius.
    """
    demand_sane(agents, radius, name)
    path = Path(path)
    occupancy = ros_map.read_map(path)
    demand_free(f"{path}:1", occupancy, unknown_is_free, "The option 'unknown-is-free'")
    _remark_cells(occupancy, unknown_is_free, remark)
    _remark_shades(occupancy, remark)
    shape: Mapping = {"type": "occupancy", "file": str(path.resolve()), "format": "ros"}
    if unknown_is_free:
        shape["unknown_is_free"] = True
    sizes = _RADII if radius is None else (radius,)
    room = _room(path, occupancy, unknown_is_free, sizes)
    places, journey, count = drawn_places(room, agents, remark)
    called = name or default_name("ros", path)
    return _scenario(called, path, shape, occupancy, places, count, room.radius, journey)


def default_name(family: str, map_path: Path, out: Path | None = None) -> str:
    """Return ``family/`` and the name of the scenario file, of the map or of its folder.

    The first of these that is not a common name is used.
    """
    folder = map_path.resolve().parent.name
    stems = ([out.stem] if out else []) + [map_path.stem, folder]
    names = [re.sub(r"[^a-z0-9]+", "-", stem.lower()).strip("-") for stem in stems]
    telling = [name for name in names if name not in _COMMON]
    return f"{family}/{(telling or ['map'])[0][:60].strip('-')}"


def _remark_cells(occupancy: Occupancy, unknown_is_free: bool, remark: Remark) -> None:
    high, wide = occupancy.blocked.shape
    free, blocked, unknown = occupancy.counts
    remark(
        f"{wide} × {high} cells of {occupancy.cell:g} m: {free} free, {blocked} blocked,"
        f" {unknown} unknown."
    )
    if unknown and unknown_is_free:
        remark("Agents may enter unknown cells.")
    elif unknown:
        remark("Agents may not enter unknown cells; the option 'unknown-is-free' opens them.")
    if occupancy.doubtful:
        remark(
            f"{occupancy.doubtful} free cells have the grey {ros_map.UNKNOWN_GREY},"
            " by which map_saver marks unknown cells.\n"
            "If they are unknown, set the map's free_thresh to 0.196 and import it again."
        )


def _remark_shades(occupancy: Occupancy, remark: Remark) -> None:
    free, blocked, _ = occupancy.counts
    share = blocked / max(free + blocked, 1)
    if share > _MOSTLY:
        remark(
            f"{100 * share:.0f} % of the known cells are blocked. If light pixels are obstacles,"
            " use\nthe option 'negate' for a picture, or `negate: 1` in the YAML file of a ROS map."
        )


def _scenario(
    name: str,
    path: Path,
    shape: Mapping,
    occupancy: Occupancy,
    places: Mapping,
    agents: int,
    radius: float,
    journey: float,
) -> Mapping:
    title = f"{agents} agents on {shown(path.name)}"
    bounds = occupancy.bounds
    walls = [{"shape": shape}]
    return scenario_mapping(name, title, bounds, False, walls, places, agents, radius, journey)


def scenario_mapping(
    name: str, title: str, bounds: Extent, walled: bool, walls: Sequence[Mapping], places: Mapping,
    agents: int, radius: float, journey: float,
) -> Mapping:  # fmt: skip
    """Return the keys of a scenario file with one team; ``journey`` [m] sets the horizon."""
    horizon = 10.0 * math.ceil(max(50.0, _PATIENCE * journey / _SPEED) / 10.0)
    team = {"name": "agents", "count": agents, "radius": radius, "max_speed": _SPEED, **places}
    return {
        "name": name,
        "version": 1,
        "title": title,
        "bounds": [float(b) for b in bounds],
        "walled": walled,
        "walls": list(walls),
        "teams": [team],
        "clock": {"dt": 0.2, "horizon": horizon},
        "rules": {"goal_tolerance": radius, "on_arrival": "vanish"},
    }


def demand_sane(agents: int | None, radius: float | None, name: str | None) -> None:
    """Refuse a wrong name, number of agents or radius. Raises UsageError."""
    demand_name(name)
    if agents is not None and agents < 1:
        raise UsageError(f"agents must be ≥ 1; got {agents}.")
    if radius is not None and not 0.0 < radius < math.inf:
        raise UsageError(f"radius must be > 0 m; got {radius}.")


def demand_name(name: str | None) -> None:
    """Raise UsageError unless ``name`` can be that of a scenario, or is None."""
    if name is not None and not (re.fullmatch(NAME_PATTERN, name) and len(name) <= MAX_NAME):
        raise UsageError(
            "A scenario's name must consist of small letters, digits, - and _, with / between its"
            f" parts, such as ros/warehouse; got {shown(name)!r}."
        )


def _room(path: Path, occupancy: Occupancy, unknown_is_free: bool, radii: Sequence[float]) -> Room:
    """Return the room of the first radius for which two agents fit, else of the last for one."""
    free, found = occupancy.free(unknown_is_free), None
    for radius in radii:
        found = largest_room(occupancy, free, radius) or found
        if found is not None and found.capacity >= 2:
            return found
    if found is None:
        cure = ", or the option 'unknown-is-free', which opens unknown cells"
        closed = occupancy.unknown.any() and not unknown_is_free
        raise MapError(
            f"{path}:1: the map must have a place for an agent; none has a radius of"
            f" {radii[-1]:g} m of free space. Try a smaller radius"
            f"{cure if closed else ''}."
        )
    return found


def drawn_places(room: Room, agents: int | None, remark: Remark) -> tuple[Mapping, float, int]:
    """Return starts and goals, the length [m] of a long journey, and the number of agents."""
    count = max(1, min(_MAX_AGENTS, room.capacity)) if agents is None else agents
    places = _within(room)
    wide, high = room.sides
    remark(
        f"{count} agent{'s' if count > 1 else ''} of radius {room.radius:g} m; starts and goals"
        f" are drawn in {wide:.1f} × {high:.1f} m,\n"
        f"at least {places['goal']['min_distance']:g} m from each other."
    )
    return places, sum(room.sides), count


def _within(room: Room) -> Mapping:
    start, goal = ({"type": "rectangle", "bounds": list(room.box)} for _ in range(2))
    apart = round(_MIN_SHARE * min(room.sides), 3)
    return {
        "start": {"type": "region", "region": start, "separation": room.radius},
        "goal": {"type": "region", "region": goal, "min_distance": apart},
    }


def points(places: FloatArray | Sequence[tuple[float, float]]) -> Mapping:
    """Return starts or goals at given places (N, 2) [m]."""
    return {"type": "points", "points": [[float(x), float(y)] for x, y in places]}


def _rows(
    path: Path, queries: movingai.Queries, agents: int | None, bucket: int | None, remark: Remark
) -> list[int]:
    """Return the rows that become agents, in the requested number."""
    left_out = len(queries.left_out)
    if left_out:
        rows_are = "row is" if left_out == 1 else "rows are"
        remark(f"{left_out} {rows_are} left out. The first:\n{queries.left_out[0]}")
    rows = journeys.choose(queries, _MAX_AGENTS if agents is None else agents, bucket)
    count = agents or 1
    if len(rows) < count:
        within = "" if bucket is None else f" in bucket {bucket}"
        cure = "Request fewer agents."
        if not rows and bucket is not None:
            cure = f"The file has buckets {queries.bucket.min()} to {queries.bucket.max()}."
        raise MapError(
            f"{path}:1: there must be {count} {'query' if count == 1 else 'queries'}{within}"
            f" with different starts and goals; there are {len(rows)}. {cure}"
        )
    return rows
