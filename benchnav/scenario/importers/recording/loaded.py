"""A recording as loaded: rows in metres, their rate, and the walkable area if the file has one."""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from benchnav.config.document import shown
from benchnav.errors import BenchnavError, ScenarioError, UsageError
from benchnav.scenario.files.track_rows import MAX_BYTES, OBSMAT, Rows, read_lines, read_rows
from benchnav.scenario.importers.recording.formats import TABLES
from benchnav.system.plain_file import open_file

if TYPE_CHECKING:
    from shapely import Polygon

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "in": 0.0254}
_MAX_ROWS = 5_000_000
_LARGEST_RATE = 1e4  # [1/s]


@dataclass(frozen=True, eq=False)
class Loaded:
    """A recording in metres."""

    rows: Rows
    rate: float  # frames per second
    area: "Polygon | None" = None  # where people can walk; None: the file does not say


def load(
    path: Path, format: str, rate: float | None, unit: str | None, columns: Sequence[str] | None
) -> Loaded:
    """Return a recording.

    Args:
        path: the file.
        format: one of `FORMATS` except "pedpy".
        rate: frames per second; None: the file's own.
        unit: m, cm, mm, ft, in, or metres per unit; None: the file's own, or metres.
        columns: of the format "text"; None: those of its header, or by their number.

    Raises:
        UsageError: the rate or the unit is missing or wrong.
        ScenarioError: the file is not of its format, with the place if it is known.
    """
    if rate is not None and not 0.0 < rate <= _LARGEST_RATE:
        raise UsageError(f"The rate must be > 0 and ≤ {_LARGEST_RATE:g} frames a second.")
    scale = None if unit is None else unit_scale(unit)
    if format in TABLES:
        return _load_table(path, format, rate, 1.0 if scale is None else scale, columns)
    if columns is not None:
        raise UsageError(f"columns do not belong to the format {format}, only to text.")
    return _load_with_pedpy(path, format, rate, scale)


def unit_scale(unit: str) -> float:
    """Return the metres per unit. Raises UsageError for an unknown unit."""
    if unit in UNITS:
        return UNITS[unit]
    try:
        scale = float(unit)
    except ValueError:
        scale = -1.0
    if not 1e-6 <= scale <= 1e6:
        raise UsageError(
            f"The unit must be {', '.join(UNITS)}, or a number of metres per unit."
            f" Got {shown(unit)!r} instead."
        )
    return scale


def _load_table(
    path: Path, format: str, rate: float | None, scale: float, columns: Sequence[str] | None
) -> Loaded:
    if rate is None:
        raise UsageError(
            f"The rate must be given: how many frames a second the frame numbers of {path} count."
            " The file does not hold it, and recordings of one family differ. Example: seq_eth of"
            " ETH has 15."
        )
    if columns is not None and format != "text":
        raise UsageError(f"columns do not belong to the format {format}, only to text.")
    known = OBSMAT if format == "eth" else columns
    rows = read_rows(path, "trajnetpp" if format == "trajnetpp" else "text", known)
    return Loaded(_scaled(rows, scale), rate)


def _scaled(rows: Rows, scale: float) -> Rows:
    if scale == 1.0:
        return rows
    return Rows(rows.path, rows.line, rows.frame, rows.number, rows.place * scale)


def _load_with_pedpy(path: Path, format: str, rate: float | None, scale: float | None) -> Loaded:
    _check_size(path, format, rate)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            data, area = _LOADERS[format](path, rate, scale)
            frame = data.data
            values = frame[["frame", "id", "x", "y"]].to_numpy(np.float64, copy=True)
            found = float(data.frame_rate)
    except BenchnavError:
        raise
    except (Exception, RecursionError) as error:  # pandas, h5py and sqlite3 raise dozens of kinds
        raise ScenarioError(f"{path}:1: {_sentence(path, format, error)}") from None
    if format not in ("juelich", "vadere") and scale is not None:
        values[:, 2:] *= scale
    values = values[~np.isnan(values[:, 2:]).any(axis=1)]
    if not len(values):
        raise ScenarioError(f"{path}:1: the file must hold at least one track.")
    if not (np.isfinite(values).all() and (np.abs(values) < 1e9).all()):
        raise ScenarioError(f"{path}:1: all numbers must be finite and below 1e9.")
    if not 0.0 < found <= _LARGEST_RATE:
        raise ScenarioError(f"{path}:1: the frame rate must be > 0; the file has {found:g}.")
    if rate is not None and abs(found - rate) > 1e-6 * rate:
        raise UsageError(
            f"The rate must be that of {path}, {found:g} frames a second. Got {rate:g} instead;"
            " leave it out."
        )
    number = values[:, 1].astype(np.int64)
    lines = np.zeros(len(values), np.int64)
    return Loaded(Rows(path, lines, values[:, 0], number, values[:, 2:].copy()), found, area)


def _check_size(path: Path, format: str, rate: float | None) -> None:
    """Refuse folders, devices, and files that would fill the memory."""
    try:
        with open_file(path) as file:
            size = file.seek(0, 2)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ScenarioError(f"{path}:1: cannot be read: {reason}.") from None
    if size > MAX_BYTES:
        raise ScenarioError(f"{path}:1: the file must be at most {MAX_BYTES} bytes; it has {size}.")
    if size == 0:
        raise ScenarioError(f"{path}:1: the file must hold at least one track; it is empty.")
    if format == "crowdit" and path.suffix == ".gz":
        _check_inflated(path)
    elif format not in ("hdf5", "jupedsim"):
        read_lines(path)  # it must be text
    if format == "vadere":
        _check_vadere(path, rate)


def _check_inflated(path: Path) -> None:
    import gzip
    import zlib

    try:
        with open_file(path) as raw, gzip.open(raw) as file:
            size = len(file.read(MAX_BYTES + 1))
    except (OSError, EOFError, zlib.error) as error:
        raise ScenarioError(f"{path}:1: must be a complete gzip file: {error}.") from None
    if size > MAX_BYTES:
        raise ScenarioError(f"{path}:1: its content must be at most {MAX_BYTES} bytes.")


def _check_vadere(path: Path, rate: float | None) -> None:
    """Refuse times that PedPy would turn into more rows than fit the memory."""
    if rate is None:
        raise UsageError(
            f"The rate must be given for {path}: Vadere writes events, which are turned into so"
            " many frames a second. PedPy's own default is 24."
        )
    lines = [line for line in read_lines(path) if not line.startswith("#")]
    names = lines[0].split(" ") if lines else []
    times = [k for k, name in enumerate(names) if "time" in name.lower()]
    latest = 0.0
    for number, line in enumerate(lines[1:], 2):
        words = line.split(" ")
        try:
            latest = max([latest, *(abs(float(words[k])) for k in times)])
        except (ValueError, IndexError):
            raise ScenarioError(
                f"{path}:{number}: must have the {len(names)} columns of its header, with numbers"
                f" as times; got {shown(line)!r}."
            ) from None
    if not latest * rate * max(1, len(lines)) < 1e10 or not latest * rate < _MAX_ROWS:
        raise ScenarioError(
            f"{path}:1: the times must be seconds; {latest:g} s at {rate:g} frames a second are"
            " too many frames."
        )


def _juelich(path: Path, rate: float | None, scale: float | None) -> tuple[Any, None]:
    import pedpy

    unit = {1.0: pedpy.TrajectoryUnit.METER, 0.01: pedpy.TrajectoryUnit.CENTIMETER}
    given = None if scale is None else unit.get(scale, pedpy.TrajectoryUnit.METER)
    data = pedpy.load_trajectory_from_txt(
        trajectory_file=path, default_frame_rate=rate, default_unit=given
    )
    if scale is not None and scale not in unit:
        table = data.data.drop(columns="point")
        table[["x", "y"]] *= scale
        data = pedpy.TrajectoryData(table, data.frame_rate)
    return data, None


def _hdf5(path: Path, rate: float | None, scale: float | None) -> tuple[Any, Any]:
    import h5py
    import pedpy

    with h5py.File(path, "r") as file:
        rows = int(np.prod(file["trajectory"].shape)) if "trajectory" in file else 0
        has_area = "wkt_geometry" in file.attrs
    if rows > _MAX_ROWS:
        raise ScenarioError(f"{path}:1: must have at most {_MAX_ROWS} rows; it has {rows}.")
    data = pedpy.load_trajectory_from_ped_data_archive_hdf5(trajectory_file=path)
    if not has_area:
        return data, None
    return data, pedpy.load_walkable_area_from_ped_data_archive_hdf5(trajectory_file=path).polygon


def _jupedsim(path: Path, rate: float | None, scale: float | None) -> tuple[Any, Any]:
    import pedpy

    data = pedpy.load_trajectory_from_jupedsim_sqlite(trajectory_file=path)
    try:
        area = pedpy.load_walkable_area_from_jupedsim_sqlite(trajectory_file=path)
    except Exception:  # a file without a geometry has none
        return data, None
    return data, area.polygon


def _vadere(path: Path, rate: float | None, scale: float | None) -> tuple[Any, None]:
    import pedpy

    data = pedpy.load_trajectory_from_vadere(
        trajectory_file=path, frame_rate=rate, ignore_too_short_trajectories=True
    )
    return data, None


def _plain(name: str) -> Callable[[Path, float | None, float | None], tuple[Any, None]]:
    def loaded(path: Path, rate: float | None, scale: float | None) -> tuple[Any, None]:
        import pedpy

        return getattr(pedpy, f"load_trajectory_from_{name}")(trajectory_file=path), None

    return loaded


_LOADERS: dict[str, Callable[[Path, float | None, float | None], tuple[Any, Any]]] = {
    "juelich": _juelich, "hdf5": _hdf5, "jupedsim": _jupedsim, "vadere": _vadere,
    "viswalk": _plain("viswalk"), "crowdit": _plain("crowdit"),
    "pathfinder-csv": _plain("pathfinder_csv"), "pathfinder-json": _plain("pathfinder_json"),
}  # fmt: skip
_NAMES = {
    "juelich": "a text file of the Jülich archive (id, frame, x, y, z)",
    "hdf5": "an HDF5 file of the Pedestrian Dynamics Data Archive",
    "jupedsim": "an SQLite file of JuPedSim", "vadere": "a trajectory file of Vadere",
    "viswalk": "a pedestrian protocol of Viswalk", "crowdit": "a trajectory file of Crowd:it",
    "pathfinder-csv": "a CSV file of Pathfinder", "pathfinder-json": "a JSON file of Pathfinder",
}  # fmt: skip


def _sentence(path: Path, format: str, error: BaseException) -> str:
    """Return what is wrong in one sentence, and the cure."""
    text = " ".join(str(error).split())
    if "Frame rate is needed" in text:
        return "has no frame rate; set the option 'rate', in frames a second."
    if "Unit is needed" in text:
        return "does not say its unit; set the option 'unit' to m or cm."
    if "unit seems to differ" in text:
        return "has another unit than the one given; leave out the option 'unit'."
    if "frame rate seems to differ" in text:
        return "has another frame rate than the one given; leave out the option 'rate'."
    reason = shown(text.removesuffix("."), 200)
    return (
        f"must be {_NAMES[format]}; message of PedPy's loader: {reason}. Set the option 'format'."
    )
