"""Scenarios made of maps: a mapping in the words of a scenario file, and the files it needs."""

import math
import re
import shutil
from pathlib import Path
from typing import Any

import yaml

from benchnav.arrays import BoolArray, FloatArray
from benchnav.errors import MapError, UsageError
from benchnav.scenario.document import shown
from benchnav.scenario.importers import movingai, ros_map
from benchnav.scenario.importers.grid import Occupancy

Mapping = dict[str, Any]

_SPEED = 1.0  # [m/s]
_PATIENCE = 3.0  # the horizon is so many times the time of an undisturbed journey


def import_movingai(
    map_path: Path | str,
    scen_path: Path | str | None = None,
    *,
    agents: int = 20,
    bucket: int | None = None,
    cell: float = 1.0,
    radius: float | None = None,
) -> Mapping:
    """A scenario on a MovingAI map.

    With a ``.scen`` file, starts and goals are those of its first rows, from above,
    that share neither a start nor a goal with one before; else they are drawn anywhere.

    Args:
        map_path: a ``.map`` file.
        scen_path: a ``.scen`` file of that map.
        agents: how many.
        bucket: takes only the rows of this bucket.
        cell: [m] a cell.
        radius: [m] of an agent; None: 0.3 cells.

    Raises:
        MapError: a file is not what it must be, or has too few rows.
        UsageError: a bucket without a ``.scen`` file.
    """
    path = Path(map_path)
    occupancy = movingai.read_map(path, cell)
    _demand_free(path, ~occupancy.blocked)
    size = 0.3 * cell if radius is None else radius
    shape = {"type": "occupancy", "file": str(path.resolve()), "format": "movingai", "cell": cell}
    if scen_path is None:
        if bucket is not None:
            raise UsageError(f"A bucket is one of a .scen file; got {bucket} without such a file.")
        places = _anywhere(occupancy, size)
        journey = _across(occupancy)
    else:
        queries = movingai.read_scen(scen_path, path, occupancy)
        rows = _rows(Path(scen_path), queries, agents, bucket)
        places = {
            "start": _points(occupancy.centres(*queries.start[rows].T)),
            "goal": _points(occupancy.centres(*queries.goal[rows].T)),
        }
        journey = float(queries.length[rows].max()) * cell
    return _scenario("movingai", path, shape, occupancy, places, agents, size, journey)


def import_ros_map(
    path: Path | str, *, agents: int = 20, radius: float = 0.2, unknown_is_free: bool = False
) -> Mapping:
    """A scenario on a map_server map, starts and goals drawn anywhere.

    Args:
        path: the map's YAML file.
        agents: how many.
        radius: [m] of an agent.
        unknown_is_free: whether agents may enter cells that the map does not know.

    Raises:
        MapError: the file is not what it must be.
    """
    path = Path(path)
    occupancy = ros_map.read_map(path)
    free = ~occupancy.blocked if unknown_is_free else ~(occupancy.blocked | occupancy.unknown)
    _demand_free(path, free)
    shape: Mapping = {"type": "occupancy", "file": str(path.resolve()), "format": "ros"}
    if unknown_is_free:
        shape["unknown_is_free"] = True
    places = _anywhere(occupancy, radius)
    return _scenario("ros", path, shape, occupancy, places, agents, radius, _across(occupancy))


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
    if agents < 1:
        raise UsageError(f"agents must be ≥ 1; got {agents}.")
    if not 0.0 < radius < math.inf:
        raise UsageError(f"radius must be > 0 m; got {radius}.")
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


def _anywhere(occupancy: Occupancy, radius: float) -> Mapping:
    region = {"type": "anywhere", "margin": radius}
    xmin, ymin, xmax, ymax = occupancy.bounds
    apart = round(0.25 * min(xmax - xmin, ymax - ymin), 3)
    return {
        "start": {"type": "region", "region": region, "separation": radius},
        "goal": {"type": "region", "region": dict(region), "min_distance": apart},
    }


def _across(occupancy: Occupancy) -> float:
    """[m] once along both sides of the map."""
    xmin, ymin, xmax, ymax = occupancy.bounds
    return (xmax - xmin) + (ymax - ymin)


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
