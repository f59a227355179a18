"""Drafts of scenarios of recorded people, as mappings with the keys of a scenario file."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.config.document import shown
from benchnav.errors import ScenarioError, UsageError
from benchnav.scenario.base import FAR
from benchnav.scenario.files.track_file import Track, tracks_of
from benchnav.scenario.importers import ros_map
from benchnav.scenario.importers.recording.loaded import Loaded, load
from benchnav.scenario.importers.recording.surroundings import (
    hull_of,
    is_image,
    read_area,
    ros_map_of,
    walls_of,
)
from benchnav.text.plural import counted

Mapping = dict[str, Any]
Remark = Callable[[str], None]

ROOM = 2.0  # [m] around the places of all people
FASTEST = 10.0  # [m/s] faster than any person on foot
SLOWEST = 0.02  # [m/s] a slower crowd is worth a remark
_PATIENCE = 2.0  # ratio of the horizon to the longest track
_HORIZON = (20.0, 300.0)  # [s] its limits
_FAR_ENOUGH = 2.0  # [m] from start to goal of a person that the robot may replace
_MAX_WALLS = 2000


@dataclass(frozen=True)
class Request:
    """The choices of an import."""

    format: str  # one of `FORMATS` except "pedpy"
    rate: float | None = None  # frames per second; None: the file's own
    unit: str | None = None  # None: the file's own, or metres
    columns: tuple[str, ...] | None = None  # of a text file; None: by its header or their number
    gaps: Literal["refuse", "split", "bridge"] = "refuse"
    replace: str = "random"  # id of a person, "random" or "none"
    driver: str | None = None  # navigator of the people who react; None: they never yield
    walls: str | None = None  # "none", "hull" or a file; None: the recording's own, or none
    wall_cell: float | None = None  # [m] of a pixel of an image of walls
    wall_origin: tuple[float, float] | None = None  # [m] its lower left corner
    wall_negate: bool = False  # whether light pixels of an image are walls
    person_radius: float = 0.2  # [m]
    radius: float | None = None  # [m] of the robot; None: that of a person
    speed: float = 1.5  # [m/s] of the robot, at most
    horizon: float | None = None  # [s] None: twice the longest track, 20 to 300 s


def import_recording(
    path: Path, name: str, request: Request, scratch: Path, remark: Remark
) -> tuple[Mapping, bytes]:
    """Return a scenario, and the table of people that its key ``recording`` names.

    Args:
        path: the recording.
        name: of the scenario.
        request: choices.
        scratch: a temporary folder, which must exist until the scenario is written.
        remark: called with each remark.

    Raises:
        UsageError: a choice is wrong or missing.
        ScenarioError, MapError: a file is wrong.
    """
    _check(request)
    loaded = load(path, request.format, request.rate, request.unit, request.columns)
    tracks = _numbered(_tracks(loaded, request, remark), remark)
    places = np.concatenate([track.place for track in tracks])
    _check_speed(path, tracks, loaded, remark)
    replace, least = _replaced(path, tracks, request)
    walls, area = _walls(loaded, request, places, scratch)
    bounds = _bounds(np.concatenate([places, area]))
    people: Mapping = {
        "file": f"{name.rsplit('/', 1)[-1]}-people.csv", "frame_time": 1.0 / loaded.rate,
        "radius": request.person_radius, "replace": replace,
    }  # fmt: skip
    if least > 0.0 and replace == "random":
        people["min_distance"] = least
    if request.gaps == "bridge":
        people["gaps"] = "bridge"
    if request.driver is not None:
        people["driver"] = request.driver
    mapping = {
        "name": name, "version": 1,
        "title": f"{_people(len(tracks))} of {shown(path.name)}",
        "bounds": bounds, "walled": False, "walls": walls, "recording": people,
        "teams": [_robot(request, replace, bounds)],
        "clock": {"dt": 0.2, "horizon": request.horizon or _horizon(tracks)},
        "rules": {"goal_tolerance": 0.5, "on_arrival": "vanish"},
    }  # fmt: skip
    return mapping, _table(tracks, loaded.rate)


def _check(request: Request) -> None:
    for name, value in (
        ("person-radius", request.person_radius), ("radius", request.radius or 1.0),
        ("speed", request.speed), ("horizon", request.horizon or 1.0),
    ):  # fmt: skip
        if not 0.0 < value < 1e5:
            raise UsageError(f"{name} must be > 0; got {value:g}.")
    if request.gaps not in ("refuse", "split", "bridge"):
        raise UsageError(f"gaps must be refuse, split or bridge; got {shown(request.gaps)!r}.")


def _tracks(loaded: Loaded, request: Request, remark: Remark) -> list[Track]:
    """Return the tracks in metres; those of a single row are left out."""
    rows, step = loaded.rows, 1.0 / loaded.rate
    if request.gaps != "refuse":
        cut = len(tracks_of(rows, step, "split")) - len(tracks_of(rows, step, "bridge"))
        done = "bridged in a straight line" if request.gaps == "bridge" else "split"
        remark(f"{counted(cut, 'gap')} in the tracks{f': {done}' if cut else ''}.")
    found = tracks_of(rows, step, request.gaps)
    tracks = [track for track in found if len(track.time) > 1]
    if len(tracks) < len(found):
        remark(f"{counted(len(found) - len(tracks), 'track')} of a single row left out.")
    if not tracks:
        raise ScenarioError(f"{rows.path}:1: the file must hold a track of at least two rows.")
    return tracks


def _numbered(tracks: Sequence[Track], remark: Remark) -> list[Track]:
    """Return the tracks with distinct ids: later pieces of a person get new ones."""
    free = max(track.number for track in tracks) + 1
    seen: set[int] = set()
    out, renamed = [], []
    for track in tracks:
        number = track.number
        if number in seen:
            number, free = free, free + 1
            renamed.append(f"{track.number} → {number}")
        seen.add(number)
        out.append(Track(number, track.time, track.place))
    if renamed:
        more = ", …" if len(renamed) > 5 else ""
        remark(f"Later pieces of split tracks have new ids: {', '.join(renamed[:5])}{more}.")
    return out


def _check_speed(path: Path, tracks: Sequence[Track], loaded: Loaded, remark: Remark) -> None:
    places = np.concatenate([track.place for track in tracks])
    extent = np.ptp(places, axis=0)
    speeds = [_length(t.place) / float(t.time[-1] - t.time[0]) for t in tracks]
    speed, duration = float(np.median(speeds)), max(float(t.time[-1]) for t in tracks)
    if speed > FASTEST:
        raise ScenarioError(
            f"{path}:1: the unit or the rate must be another: people would walk at {speed:.3g} m/s"
            f" (median) with {loaded.rate:g} frames a second. Set the option 'unit', such as cm."
        )
    if np.abs(places).max() > 0.9 * FAR:
        raise ScenarioError(
            f"{path}:1: coordinates must be within ± {0.9 * FAR:g} m; the largest is"
            f" {np.abs(places).max():.6g} m. Set the option 'unit', or move the recording."
        )
    remark(
        f"{counted(len(places), 'row')}, {_people(len(tracks))},"
        f" {duration:.1f} s at {loaded.rate:g} frames a second,"
        f" {extent[0]:.1f} × {extent[1]:.1f} m, {speed:.2f} m/s (median)."
    )
    if speed < SLOWEST:
        remark("People hardly move: check the options 'unit' and 'rate'.")


def _length(place: FloatArray) -> float:
    return float(np.hypot(*np.diff(place, axis=0).T).sum())


def _replaced(path: Path, tracks: Sequence[Track], request: Request) -> tuple[int | str, float]:
    """Return the person that is replaced, and the smallest distance [m] from start to goal."""
    if request.replace in ("random", "none"):
        far = max(math.hypot(*(t.place[-1] - t.place[0])) for t in tracks)
        return request.replace, _FAR_ENOUGH if far >= _FAR_ENOUGH else 0.0
    numbers = sorted(track.number for track in tracks)
    try:
        number = int(request.replace)
    except ValueError:
        number = -1
    if number not in numbers:
        raise UsageError(
            "The robot must replace an id of the recording, 'random' or 'none'. Got"
            f" {shown(request.replace)!r}; {path} has {', '.join(map(str, numbers[:10]))}"
            f"{', …' if len(numbers) > 10 else ''}."
        )
    return number, 0.0


def _walls(
    loaded: Loaded, request: Request, places: FloatArray, scratch: Path
) -> tuple[list[Mapping], FloatArray]:
    """Return the walls, and corners (N, 2) [m] of a box around them."""
    given = request.walls
    if given is not None and given not in ("none", "hull"):
        path = Path(given)
        if is_image(path):
            path = ros_map_of(
                path, request.wall_cell, request.wall_origin, request.wall_negate, scratch
            )
        if path.suffix in (".yaml", ".yml"):
            x0, y0, x1, y1 = ros_map.read_map(path).bounds
            shape = {"type": "occupancy", "file": str(path.resolve()), "format": "ros"}
            return [{"shape": shape}], np.array([[x0, y0], [x1, y1]])
        area: Any = read_area(path)
    else:
        area = {None: loaded.area, "none": None, "hull": hull_of(places)}[given]
    if area is None:
        return [], np.zeros((0, 2))
    walls = list(walls_of(area))
    if len(walls) > _MAX_WALLS:
        raise UsageError(f"The walls must have at most {_MAX_WALLS} pieces; got {len(walls)}.")
    x0, y0, x1, y1 = area.bounds
    return walls, np.array([[x0, y0], [x1, y1]])


def _people(count: int) -> str:
    return "1 person" if count == 1 else f"{count} people"


def _bounds(points: FloatArray) -> list[float]:
    low, high = points.min(axis=0) - ROOM, points.max(axis=0) + ROOM
    return [math.floor(low[0]), math.floor(low[1]), math.ceil(high[0]), math.ceil(high[1])]


def _horizon(tracks: Sequence[Track]) -> float:
    longest = max(float(track.time[-1] - track.time[0]) for track in tracks)
    seconds = min(max(_PATIENCE * longest, _HORIZON[0]), _HORIZON[1])
    return 10.0 * math.ceil(seconds / 10.0)


def _robot(request: Request, replace: int | str, bounds: Sequence[float]) -> Mapping:
    radius = request.radius or request.person_radius
    team: Mapping = {"name": "robot", "radius": radius, "max_speed": request.speed}
    if replace != "none":
        return {**team, "start": {"type": "recorded"}, "goal": {"type": "recorded"}}
    start, goal = ({"type": "rectangle", "bounds": [*bounds]} for _ in range(2))
    apart = round(0.25 * min(bounds[2] - bounds[0], bounds[3] - bounds[1]), 3)
    return {
        **team, "start": {"type": "region", "region": start},
        "goal": {"type": "region", "region": goal, "min_distance": apart},
    }  # fmt: skip


def _table(tracks: Sequence[Track], rate: float) -> bytes:
    """Return the tracks as text, in metres and with all digits."""
    lines = ["frame,id,x,y"]
    for track in tracks:
        frames = track.time * rate
        whole = np.rint(frames)
        exact = np.where(np.abs(frames - whole) < 1e-6, whole, frames)
        for frame, (x, y) in zip(exact.tolist(), track.place.tolist(), strict=True):
            lines.append(f"{frame:.10g},{track.number},{x!r},{y!r}")
    return ("\n".join(lines) + "\n").encode()
