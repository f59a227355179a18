"""Convert worlds, meshes, geometries and pictures into scenario files."""

from collections.abc import Iterable, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

from benchnav.api.output.messages import message, silent
from benchnav.errors import UsageError, did_you_mean
from benchnav.processes.main_module import stop_import_of_main
from benchnav.scenario.importers import default_name, write_scenario

FORMATS = ("sdf", "mesh", "wkt", "image")
_SUFFIXES = {
    ".sdf": "sdf", ".world": "sdf", ".wkt": "wkt",
    **dict.fromkeys((".dae", ".obj", ".off", ".ply", ".stl"), "mesh"),
    **dict.fromkeys((".png", ".pgm", ".bmp", ".jpg", ".jpeg", ".gif", ".tif", ".tiff"), "image"),
}  # fmt: skip
_OPTIONS = {
    "sdf": ("unit", "up", "scale", "band", "models", "skip_missing"),
    "mesh": ("unit", "up", "scale", "band"),
    "wkt": ("unit", "obstacles"),
    "image": ("resolution", "threshold", "negate", "origin"),
}
_PLACES = ("bounds", "margin", "start", "goal")


def import_world(
    file: "str | PathLike[str]",
    out: "str | PathLike[str]",
    *,
    format: str | None = None,
    unit: float | None = None,
    up: str | None = None,
    scale: "float | Sequence[float] | None" = None,
    band: "Sequence[float] | None" = None,
    models: "Iterable[str | PathLike[str]]" = (),
    skip_missing: bool = False,
    obstacles: bool = False,
    resolution: float | None = None,
    threshold: float | None = None,
    negate: bool = False,
    origin: "Sequence[float] | None" = None,
    bounds: "Sequence[float] | None" = None,
    margin: float | None = None,
    start: "Sequence[float] | None" = None,
    goal: "Sequence[float] | None" = None,
    agents: int | None = None,
    radius: float | None = None,
    name: str | None = None,
    force: bool = False,
    quiet: bool = False,
) -> list[Path]:
    """Convert obstacles of another program into a scenario; return the files, the scenario first.

    Args:
        file: an SDF world or model of Gazebo, a mesh (COLLADA, STL, OBJ, PLY, OFF), a WKT geometry
            of JuPedSim or PedPy, or a picture.
        out: the scenario file.
        format: sdf, mesh, wkt or image; None: by the suffix of ``file``.
        unit: [m] of the file's unit; None: as the file or its meshes declare, else 1.
        up: vertical axis of meshes, x, y or z; None: as the file declares; in an SDF world z,
            because Gazebo ignores what meshes declare.
        scale: factor of meshes, or three along x, y and z (mesh).
        band: low, high [m]: heights at which there are obstacles; None: 0.05, 2.
        models: folders in which the models of an SDF world are searched.
        skip_missing: leave out models and meshes that are not found.
        obstacles: whether the polygons of a WKT file are obstacles, not the walkable area.
        resolution: [m] of a pixel; a picture needs it.
        threshold: darkness of obstacles in a picture, 0 to 1; None: 0.5.
        negate: whether light pixels are obstacles.
        origin: x, y [m] of the picture's lower left corner; None: 0, 0.
        bounds: xmin, ymin, xmax, ymax [m] of the arena; None: around the obstacles.
        margin: [m] around the obstacles, start and goal; None: 1.
        start: x, y [m] of a single agent; None: starts are drawn.
        goal: x, y [m] of that agent.
        agents: their number; None: 20, or fewer in a small arena.
        radius: of an agent [m]; None: 0.2; in a picture 0.2 or less.
        name: of the scenario; None: from ``out``, the file or its folder.
        force: overwrite the scenario file.
        quiet: print no remarks.

    Raises WorldFileError, MeshError or MapError for a wrong file, with the place, and UsageError
    for a mistake in the call.
    """
    stop_import_of_main()
    path, target = Path(file), Path(out)
    kind = _format(path, format)
    given = {
        "unit": unit, "up": up, "scale": scale, "band": band, "models": list(models) or None,
        "skip_missing": skip_missing or None, "obstacles": obstacles or None,
        "resolution": resolution, "threshold": threshold, "negate": negate or None,
        "origin": origin, "bounds": bounds, "margin": margin, "start": start, "goal": goal,
    }  # fmt: skip
    allowed = (*_OPTIONS[kind], *(() if kind == "image" else _PLACES))
    for option, value in given.items():
        if value is not None and option not in allowed:
            raise UsageError(f"{option} does not belong to the format {kind}. Got {value!r}.")
    say = silent if quiet else message
    called = name or default_name(kind, path, target)
    if kind == "image":
        return _image(path, target, given, agents, radius, called, force, say)
    from benchnav.scenario.importers.world_draft import WorldOptions

    if margin is not None and not 0.0 <= margin < float("inf"):
        raise UsageError(f"margin must be ≥ 0 m. Got {margin} instead.")
    options = WorldOptions(
        name=called, agents=agents, radius=radius, bounds=_numbers("bounds", bounds, 4),
        margin=1.0 if margin is None else margin, start=_numbers("start", start, 2),
        goal=_numbers("goal", goal, 2), remark=say,
    )  # fmt: skip
    return write_scenario(_draft(kind, path, given, options), target, force)


def _draft(kind: str, path: Path, given: dict[str, Any], options: Any) -> dict[str, Any]:
    from benchnav.scenario.importers.sdf import SdfOptions
    from benchnav.scenario.importers.worlds import import_mesh, import_sdf, import_wkt

    unit, up = given["unit"], given["up"]
    if unit is not None and not 0.0 < unit < float("inf"):
        raise UsageError(f"unit must be > 0 m. Got {unit} instead.")
    if up not in (None, "x", "y", "z"):
        raise UsageError(f"up must be x, y or z. Got {up!r} instead.")
    if kind == "wkt":
        return import_wkt(path, options, unit=unit or 1.0, obstacles=bool(given["obstacles"]))
    low, high = _numbers("band", given["band"], 2) or (0.05, 2.0)
    if not low < high:
        raise UsageError(f"band must be low, high with low < high. Got {low:g}, {high:g}.")
    scale = _scale(given["scale"])
    if kind == "mesh":
        return import_mesh(path, options, unit=unit, up=up, scale=scale, band=(low, high))
    if len(set(scale)) > 1:
        raise UsageError("The scale of an SDF world must be one number. Got several.")
    sdf = SdfOptions(
        band=(low, high), unit=unit, up=up, scale=scale[0],
        models=[Path(folder) for folder in given["models"] or ()],
        skip_missing=bool(given["skip_missing"]),
    )  # fmt: skip
    return import_sdf(path, options, sdf)


def _image(
    path: Path, target: Path, given: dict[str, Any], agents: int | None, radius: float | None,
    name: str, force: bool, say: Any,
) -> list[Path]:  # fmt: skip
    from benchnav.scenario.importers.picture import DARK, import_image

    if given["resolution"] is None:
        raise UsageError("A picture has no size in metres. Give the resolution: metres per pixel.")
    threshold = DARK if given["threshold"] is None else given["threshold"]
    return import_image(
        path, target, resolution=given["resolution"], threshold=threshold,
        negate=bool(given["negate"]), origin=_numbers("origin", given["origin"], 2) or (0.0, 0.0),
        agents=agents, radius=radius, name=name, force=force, remark=say,
    )  # fmt: skip


def _scale(scale: "float | Sequence[float] | None") -> tuple[float, float, float]:
    factors = (1.0,) if scale is None else (scale,) if isinstance(scale, (int, float)) else scale
    found = tuple(float(factor) for factor in factors)
    found = found * 3 if len(found) == 1 else found
    if len(found) != 3 or not all(0.0 < factor < float("inf") for factor in found):
        raise UsageError(f"scale must be one or three numbers > 0. Got {scale!r} instead.")
    return found[0], found[1], found[2]


def _numbers(name: str, values: "Sequence[float] | None", count: int) -> Any:
    """Return a tuple of finite numbers; None for None."""
    if values is None:
        return None
    found = tuple(float(value) for value in values)
    if len(found) != count or not all(abs(value) <= 1e6 for value in found):
        raise UsageError(f"{name} must be {count} numbers up to 1e6. Got {values!r} instead.")
    return found


def _format(file: Path, format: str | None) -> str:
    kind = _SUFFIXES.get(file.suffix.lower()) if format is None else format
    if kind is None:
        raise UsageError(
            f"The format must be given where the suffix is none of {', '.join(_SUFFIXES)}:"
            f" {', '.join(FORMATS)}. Got the file {file}."
        )
    if kind not in FORMATS:
        raise UsageError(
            f"The format must be one of {', '.join(FORMATS)}. Got {kind!r} instead."
            f"{did_you_mean(kind, FORMATS)}"
        )
    return kind
