"""Scenarios made of maps: a mapping in the words of a scenario file, and the files it needs."""

import math
import re
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import yaml

from benchnav.arrays import BoolArray, FloatArray
from benchnav.errors import MapError, UsageError
from benchnav.scenario.document import shown
from benchnav.scenario.importers import movingai, ros_map
from benchnav.scenario.importers.grid import Occupancy
from benchnav.scenario.importers.room import Room, largest_room

Mapping = dict[str, Any]

_MOST = 20  # agents, unless more are asked for
_RADII = tuple(0.2 / 2**k for k in range(6))  # [m]
_SPEED = 1.0  # [m/s]
_APART = 0.25  # of the smaller side of where they are: start and goal, at least
_PATIENCE = 3.0  # the horizon is so many times the time of an undisturbed journey


def import_movingai(
    map_path: Path | str,
    scen_path: Path | str | None = None,
    *,
    agents: int | None = None,
    bucket: int | None = None,
    cell: float = 1.0,
    radius: float | None = None,
) -> Mapping:
    """A scenario on a MovingAI map.

    With a ``.scen`` file, starts and goals are those of its first rows, from above,
    that share neither a start nor a goal with one before; else they are drawn as on a
    map_server map.

    Args:
        map_path: a ``.map`` file.
        scen_path: a ``.scen`` file of that map.
        agents: how many; None: 20, or without a ``.scen`` file as many as have room.
        bucket: takes only the rows of this bucket.
        cell: [m] a cell.
        radius: [m] of an agent; None: 0.3 cells.

    Raises:
        MapError: a file is not what it must be, has too few rows, or no agent has room.
        UsageError: a bucket without a ``.scen`` file, or no agents, or no radius.
    """
    _demand_sane(agents, radius)
    path = Path(map_path)
    occupancy = movingai.read_map(path, cell)
    _demand_free(path, ~occupancy.blocked)
    size = 0.3 * cell if radius is None else radius
    shape = {"type": "occupancy", "file": str(path.resolve()), "format": "movingai", "cell": cell}
    if scen_path is None:
        if bucket is not None:
            raise UsageError(f"A bucket is one of a .scen file; got {bucket} without such a file.")
        room = _room(path, occupancy, ~occupancy.blocked, (size,))
        agents = _crew(room) if agents is None else agents
        places, journey = _within(room), sum(room.sides)
    else:
        agents = _MOST if agents is None else agents
        queries = movingai.read_scen(scen_path, path, occupancy)
        rows = _rows(Path(scen_path), queries, agents, bucket)
        places = {
            "start": _points(occupancy.centres(*queries.start[rows].T)),
            "goal": _points(occupancy.centres(*queries.goal[rows].T)),
        }
        journey = float(queries.length[rows].max()) * cell
    return _scenario("movingai", path, shape, occupancy, places, agents, size, journey)


def import_ros_map(
    path: Path | str,
    *,
    agents: int | None = None,
    radius: float | None = None,
    unknown_is_free: bool = False,
) -> Mapping:
    """A scenario on a map_server map.

    Starts and goals are drawn in the largest part of the map that agents can be in,
    goals at least a quarter of its smaller side away.

    Args:
        path: the map's YAML file.
        agents: how many; None: 20, or as many as have room.
        radius: [m] of an agent; None: 0.2 m, or half of it, a quarter, … until two have room.
        unknown_is_free: whether agents may enter cells that the map does not know.

    Raises:
        MapError: the file is not what it must be, or no agent has room.
        UsageError: no agents, or no radius.
    """
    _demand_sane(agents, radius)
    path = Path(path)
    occupancy = ros_map.read_map(path)
    free = ~occupancy.blocked if unknown_is_free else ~(occupancy.blocked | occupancy.unknown)
    _demand_free(path, free)
    shape: Mapping = {"type": "occupancy", "file": str(path.resolve()), "format": "ros"}
    if unknown_is_free:
        shape["unknown_is_free"] = True
    sizes = _RADII if radius is None else (radius,)
    room = _room(path, occupancy, free, sizes)
    count = _crew(room) if agents is None else agents
    places, journey = _within(room), sum(room.sides)
    return _scenario("ros", path, shape, occupancy, places, count, room.radius, journey)


def write_scenario(mapping: Mapping, out: Path | str, force: bool = False) -> list[Path]:
    """Writes a scenario as YAML and copies its maps beside it, so that the folder is complete.

    Returns the paths of all files, the scenario first.

    Raises:
        UsageError: a file is there already and ``force`` is not given, or cannot be written.
        MapError: a map cannot be read any more.
    """
    out = Path(out)
    contents: dict[Path, bytes | Path] = {}
    copy = {**mapping, "walls": [dict(wall) for wall in mapping.get("walls", [])]}
    for wall in copy["walls"]:
        source = Path(wall["shape"]["file"])
        contents.update(_copies(source, wall["shape"].get("format", ""), out.parent))
        wall["shape"] = {**wall["shape"], "file": source.name}
    text = yaml.safe_dump(copy, sort_keys=False, default_flow_style=None, allow_unicode=True)
    if out in contents:
        raise UsageError(f"{out} is the map's own name; give the scenario another one.")
    contents = {out: text.encode(), **contents}
    changed = {p: c for p, c in contents.items() if not _same(p, c)}
    present = [str(path) for path in changed if path.exists()]
    if present and not force:
        raise UsageError(f"{', '.join(present)} must not exist yet; it would be overwritten.")
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        for path, content in changed.items():
            if isinstance(content, Path):
                shutil.copyfile(content, path)
            else:
                path.write_bytes(content)
    except OSError as error:
        raise UsageError(f"{out.parent} must be writable; {error.strerror or error}.") from None
    return list(contents)


def _same(path: Path, content: bytes | Path) -> bool:
    return isinstance(content, Path) and path.exists() and path.samefile(content)


def _copies(source: Path, format: str, folder: Path) -> dict[Path, bytes | Path]:
    """What must stand in ``folder``: file → its bytes, or the file to copy."""
    if format != "ros":
        return {folder / source.name: source}
    document, spec = ros_map.read_header(source)
    image = ros_map.image_path(document, spec)
    if spec.image == image.name:
        return {folder / source.name: source, folder / image.name: image}
    renamed = {**document.data, "image": image.name}
    text = yaml.safe_dump(renamed, sort_keys=False, default_flow_style=None)
    return {folder / source.name: text.encode(), folder / image.name: image}


def _scenario(
    family: str,
    path: Path,
    shape: Mapping,
    occupancy: Occupancy,
    places: Mapping,
    agents: int,
    radius: float,
    journey: float,
) -> Mapping:
    name = re.sub(r"[^a-z0-9]+", "-", path.stem.lower()).strip("-") or "map"
    horizon = 10.0 * math.ceil(max(50.0, _PATIENCE * journey / _SPEED) / 10.0)
    team = {"name": "agents", "count": agents, "radius": radius, "max_speed": _SPEED, **places}
    return {
        "name": f"{family}/{name[:60].strip('-')}",
        "version": 1,
        "title": f"{agents} agents on {shown(path.name)}",
        "bounds": [float(b) for b in occupancy.bounds],
        "walled": False,
        "walls": [{"shape": shape}],
        "teams": [team],
        "clock": {"dt": 0.2, "horizon": horizon},
        "rules": {"goal_tolerance": radius, "on_arrival": "vanish"},
    }


def _demand_sane(agents: int | None, radius: float | None) -> None:
    if agents is not None and agents < 1:
        raise UsageError(f"agents must be ≥ 1; got {agents}.")
    if radius is not None and not 0.0 < radius < math.inf:
        raise UsageError(f"radius must be > 0 m; got {radius}.")


def _room(path: Path, occupancy: Occupancy, free: BoolArray, radii: Sequence[float]) -> Room:
    """Of the first radius for which two agents have room, else of the last for which one has."""
    found = None
    for radius in radii:
        found = largest_room(occupancy, free, radius) or found
        if found is not None and found.capacity >= 2:
            return found
    if found is None:
        raise MapError(
            f"{path}:1: the map must have a place for an agent; none has a radius of"
            f" {radii[-1]:g} m free around it. Try a smaller radius."
        )
    return found


def _crew(room: Room) -> int:
    return max(1, min(_MOST, room.capacity))


def _within(room: Room) -> Mapping:
    start, goal = ({"type": "rectangle", "bounds": list(room.box)} for _ in range(2))
    apart = round(_APART * min(room.sides), 3)
    return {
        "start": {"type": "region", "region": start, "separation": room.radius},
        "goal": {"type": "region", "region": goal, "min_distance": apart},
    }


def _points(places: FloatArray) -> Mapping:
    return {"type": "points", "points": [[float(x), float(y)] for x, y in places]}


def _rows(path: Path, queries: movingai.Queries, agents: int, bucket: int | None) -> list[int]:
    """The first rows with starts and goals of their own."""
    starts: set[tuple[int, ...]] = set()
    goals: set[tuple[int, ...]] = set()
    rows: list[int] = []
    for row in range(len(queries.length)):
        start, goal = tuple(queries.start[row].tolist()), tuple(queries.goal[row].tolist())
        wanted = bucket is None or queries.bucket[row] == bucket
        if wanted and start != goal and start not in starts and goal not in goals:
            starts.add(start)
            goals.add(goal)
            rows.append(row)
        if len(rows) == agents:
            return rows
    within = "" if bucket is None else f" in bucket {bucket}"
    raise MapError(
        f"{path}:1: there must be {agents} queries{within} that share no start and no goal; "
        f"there are {len(rows)}. Ask for fewer agents."
    )


def _demand_free(path: Path, free: BoolArray) -> None:
    if not free.any():
        raise MapError(f"{path}:1: the map must have a free cell; all are blocked.")
