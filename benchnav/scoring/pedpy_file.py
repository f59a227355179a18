"""Trajectories that PedPy's loaders read."""

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

from benchnav.errors import TrajectoryError, UsageError
from benchnav.scoring.table_file import MAX_ROWS, Table, bytes_of

METRES, CENTIMETRES = 1.0, 0.01


def _text(path: Path, rate: float | None, unit: float | None) -> Any:
    import pedpy

    units = {METRES: pedpy.TrajectoryUnit.METER, CENTIMETRES: pedpy.TrajectoryUnit.CENTIMETER}
    if unit is not None and unit not in units:
        raise UsageError(f"The unit of a text file of PedPy must be 1 or 0.01 m. Got {unit:g} m.")
    return pedpy.load_trajectory_from_txt(
        trajectory_file=path, default_frame_rate=rate,
        default_unit=None if unit is None else units[unit],
    )  # fmt: skip


def _vadere(path: Path, rate: float | None, unit: float | None) -> Any:
    import pedpy

    if rate is None:
        raise UsageError("A trajectory of Vadere has no frames. Give a rate, in frames a second.")
    return pedpy.load_trajectory_from_vadere(trajectory_file=path, frame_rate=rate)


def _plain(loader: str) -> Callable[[Path, float | None, float | None], Any]:
    def load(path: Path, rate: float | None, unit: float | None) -> Any:
        import pedpy

        return getattr(pedpy, loader)(trajectory_file=path)

    return load


def _hdf5(path: Path, rate: float | None, unit: float | None) -> Any:
    import h5py
    import pedpy

    with h5py.File(path, "r") as file:  # its size on disk does not bound the number of its rows
        rows = file["trajectory"].shape[0] if "trajectory" in file else 0
    if rows > MAX_ROWS:
        raise TrajectoryError(f"{path}: a recording has at most {MAX_ROWS} rows; got {rows}.")
    return pedpy.load_trajectory_from_ped_data_archive_hdf5(trajectory_file=path)


LOADERS: dict[str, Callable[[Path, float | None, float | None], Any]] = {
    "pedpy": _text,
    "hdf5": _hdf5,
    "jupedsim": _plain("load_trajectory_from_jupedsim_sqlite"),
    "vadere": _vadere,
    "viswalk": _plain("load_trajectory_from_viswalk"),
    "crowdit": _plain("load_trajectory_from_crowdit"),
    "pathfinder": _plain("load_trajectory_from_pathfinder_csv"),
}
"""Format → a function of path, frame rate [Hz] and unit [m]."""


def read_pedpy(path: Path, format: str, rate: float | None, unit: float | None) -> Table:
    """Return the trajectories of a file that PedPy reads.

    Raises TrajectoryError if PedPy cannot read it, UsageError if it needs a rate or unit.
    """
    bytes_of(path)  # a regular file of limited size
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # PedPy's loaders repair some files, with a warning
            found = LOADERS[format](path, rate, unit)
        frame = found.data[["id", "frame", "x", "y"]].astype(
            {"id": str, "frame": float, "x": float, "y": float}
        )
        held = float(found.frame_rate)
    except (TrajectoryError, UsageError):
        raise
    except Exception as error:  # every loader raises its own errors
        text = " ".join(str(error).split()).split(". ")[0][:160].rstrip(".")
        raise TrajectoryError(
            f"{path}:1: the file must be a {format} file that PedPy reads; {text or 'it is not'}."
            f"{_cure(text)}"
        ) from None
    if len(frame) > MAX_ROWS:
        raise TrajectoryError(f"{path}: a recording has at most {MAX_ROWS} rows; got {len(frame)}.")
    if not 0.0 < held < float("inf"):
        raise TrajectoryError(f"{path}:1: the frame rate must be > 0 Hz; got {held:g}.")
    return Table(path, frame.reset_index(drop=True), held, None)


def _cure(text: str) -> str:
    if "rame rate" in text:
        return " Give the option 'rate', in frames a second."
    return " Give the option 'unit': 1 or 0.01 m." if "nit is needed" in text else ""
