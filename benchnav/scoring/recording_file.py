"""Recordings as tables: the formats of `benchnav import recording`."""

from pathlib import Path

from benchnav.errors import ScenarioError, TrajectoryError
from benchnav.scenario.importers.recording.formats import find_format
from benchnav.scenario.importers.recording.loaded import load
from benchnav.scoring.table_file import MAX_ROWS, Table


def read_recording(path: Path, format: str | None, rate: float | None, unit: float | None) -> Table:
    """Return the rows of a recording; lengths are in metres.

    Args:
        path: the file.
        format: one of `benchnav.scenario.importers.recording.formats.FORMATS`; None: by its suffix
            and first lines.
        rate: [Hz] of the frames; None: the file's own.
        unit: metres per unit of length; None: the file's own, else 1.

    Raises TrajectoryError if the file is wrong, UsageError if it needs a format, rate or unit.
    """
    import pandas as pd

    try:
        found = load(
            path, find_format(path, format), rate, None if unit is None else repr(float(unit)), None
        )
    except ScenarioError as error:
        raise TrajectoryError(str(error)) from None
    rows = found.rows
    if len(rows.frame) > MAX_ROWS:
        raise TrajectoryError(
            f"{path}: a recording has at most {MAX_ROWS} rows; got {len(rows.frame)}."
        )
    frame = pd.DataFrame(
        {
            "id": rows.number.astype(str), "frame": rows.frame,
            "x": rows.place[:, 0], "y": rows.place[:, 1],
        }
    )  # fmt: skip
    return Table(path, frame, found.rate, None, rows.line if (rows.line > 0).all() else None)
