"""Convert maps of other projects into scenario files."""

from os import PathLike
from pathlib import Path
from typing import Any

from benchnav.api.output.messages import message, silent
from benchnav.errors import UsageError, did_you_mean
from benchnav.processes.main_module import stop_import_of_main
from benchnav.scenario.importers import (
    default_name,
    import_movingai,
    import_ros_map,
    write_scenario,
)

FORMATS = ("movingai", "ros-map")
_SUFFIXES = {".map": "movingai", ".yaml": "ros-map", ".yml": "ros-map"}


def import_map(
    map: "str | PathLike[str]",
    out: "str | PathLike[str]",
    *,
    format: str | None = None,
    scen: "str | PathLike[str] | None" = None,
    agents: int | None = None,
    bucket: int | None = None,
    cell: float | None = None,
    radius: float | None = None,
    unknown_is_free: bool = False,
    name: str | None = None,
    force: bool = False,
    quiet: bool = False,
) -> list[Path]:
    """Convert a published map into a scenario, and return the files written, the scenario first.

    Args:
        map: a grid map of the MovingAI benchmarks (``.map``), or the YAML file of an occupancy
            map of the ROS map_server.
        out: the scenario file; the map is copied beside it.
        format: "movingai" or "ros-map"; None: by the suffix of ``map``.
        scen: starts and goals from this ``.scen`` file of MovingAI; None: they are drawn.
        agents: their number; None: 20, or fewer in a small map.
        bucket: only queries of this bucket of the ``.scen`` file.
        cell: side of a cell [m] of a MovingAI map; None: 1.
        radius: of an agent [m]; None: 0.3 cells (MovingAI), or 0.2 m or less (ROS).
        unknown_is_free: agents may enter unknown cells of a ROS map.
        name: of the scenario; None: from ``out``, the map or its folder.
        force: overwrite the scenario file. A map is never overwritten.
        quiet: print no remarks on the map.

    Raises MapError for a wrong map, and UsageError for a mistake in the call.
    """
    stop_import_of_main()
    path, target, kind = Path(map), Path(out), _format(Path(map), format)
    common: dict[str, Any] = {
        "agents": agents, "radius": radius, "remark": silent if quiet else message,
    }  # fmt: skip
    if kind == "movingai":
        _refuse(kind, unknown_is_free=unknown_is_free)
        common["name"] = name or default_name("movingai", path, target)
        side = 1.0 if cell is None else cell
        scenario = import_movingai(path, _path(scen), bucket=bucket, cell=side, **common)
    else:
        _refuse(kind, scen=scen, bucket=bucket, cell=cell)
        common["name"] = name or default_name("ros", path, target)
        scenario = import_ros_map(path, unknown_is_free=unknown_is_free, **common)
    return write_scenario(scenario, target, force)


def _format(map: Path, format: str | None) -> str:
    if format is None and map.suffix not in _SUFFIXES:
        raise UsageError(
            f"The format must be given where the map's suffix is none of {', '.join(_SUFFIXES)}:"
            f" {' or '.join(FORMATS)}. Got the map {map}."
        )
    kind = _SUFFIXES[map.suffix] if format is None else format
    if kind not in FORMATS:
        raise UsageError(
            f"The format must be {' or '.join(FORMATS)}. Got {format!r} instead."
            f"{did_you_mean(kind, FORMATS)}"
        )
    return kind


def _refuse(format: str, **options: Any) -> None:
    for name, value in options.items():
        if value is not None and value is not False:
            raise UsageError(f"{name} does not belong to the format {format}. Got {value!r}.")


def _path(file: "str | PathLike[str] | None") -> Path | None:
    return None if file is None else Path(file)
