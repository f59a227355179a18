"""Tables of trajectories: CSV and Parquet files with one row per time and id."""

import io
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.config.document import shown
from benchnav.errors import TrajectoryError, UsageError, did_you_mean
from benchnav.system.plain_file import read_file
from benchnav.text.plural import listed

if TYPE_CHECKING:
    import pandas as pd

MAX_BYTES = 128 << 20
MAX_ROWS = 5_000_000
MAX_COLUMNS = 1_000
MAX_DECODED = 1 << 30  # [bytes] of a Parquet table
MAX_NAME = 200  # characters of an id or another text
LARGEST = 1e7  # [m], [s] larger numbers are no positions and no times

NAMES = {
    "time": ("t", "time_s", "seconds", "simtime", "sim_time"),
    "frame": ("frame_id", "frame_number"),
    "id": ("agent", "agent_id", "person", "person_id", "ped", "pedestrian", "pedestrian_id",
           "ped_id", "track_id"),
    "x": ("x_m", "pos_x", "position_x"),
    "y": ("y_m", "pos_y", "position_y"),
    "heading": ("yaw", "theta"),
    "radius": (),
    "goal_x": ("gx",),
    "goal_y": ("gy",),
    "preferred_speed": ("v_pref",),
    "body_length": (), "body_width": (), "corner_radius": (),
    "team": ("group",),
    "navigator": (), "scenario": (), "track": (), "perception": (), "split": (), "seed": (),
}  # fmt: skip
"""Column → other names that are recognised, in lower case."""
TEXTS = ("id", "team", "navigator", "scenario", "track", "perception", "split")
LENGTHS = (
    "x", "y", "radius", "goal_x", "goal_y", "preferred_speed", "body_length", "body_width",
    "corner_radius",
)  # fmt: skip
Columns = Mapping[str, str]


@dataclass(frozen=True, eq=False)
class Table:
    """The rows of a file. ``lines`` are those of the file, for messages."""

    path: Path
    frame: "pd.DataFrame"  # columns of `NAMES`; numbers are float64, texts are str
    rate: float | None = None  # [Hz] of the column frame, where the file declares it
    first_line: int | None = 2  # of the first row; None: the file has no lines
    lines: IntArray | None = None  # (N,) of the rows, where they do not follow each other

    def __len__(self) -> int:
        return len(self.frame)

    def column(self, name: str) -> FloatArray | None:
        """Return a column of numbers (N,); None without it."""
        if name not in self.frame:
            return None
        return self.frame[name].to_numpy(np.float64)

    def place(self, row: int) -> str:
        """Return where a row is, for a message."""
        if self.lines is not None:
            return f"{self.path}:{self.lines[row]}"
        if self.first_line is None:
            return f"{self.path}: row {row + 1}"
        return f"{self.path}:{self.first_line + row}"


def read_table(path: Path, format: str, columns: Columns, unit: float) -> Table:
    """Return the table in a CSV or Parquet file; lengths are in metres.

    Args:
        path: the file.
        format: "csv" or "parquet".
        columns: column of benchnav → column of the file, where it is not recognised.
        unit: metres per unit of length.

    Raises TrajectoryError with the place, UsageError for unknown columns in ``columns``.
    """
    for name in columns:
        if name not in NAMES:
            raise UsageError(
                f"A column must be one of {', '.join(NAMES)}. Got {name!r} instead."
                f"{did_you_mean(name, NAMES)}"
            )
    raw = bytes_of(path)
    texts, line = _parquet(path, raw) if format == "parquet" else _csv(path, raw)
    if not len(texts):
        raise TrajectoryError(f"{path}: the table must have at least one row; it has none.")
    if len(texts) > MAX_ROWS:
        raise TrajectoryError(
            f"{path}: a table has at most {MAX_ROWS} rows; got {len(texts)}. Score a part of it."
        )
    return _converted(path, texts, line, _found(path, list(texts.columns), columns), unit)


def bytes_of(path: Path) -> bytes:
    """Return the content of a file. Raises TrajectoryError if it cannot be read or is too large."""
    try:
        raw = read_file(path, MAX_BYTES)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise TrajectoryError(f"{path}: the file must be readable; {reason}.") from None
    if len(raw) > MAX_BYTES:
        raise TrajectoryError(
            f"{path}: the file must have at most {MAX_BYTES >> 20} MiB; it is larger."
            " Score a part of it."
        )
    if not raw.strip():
        raise TrajectoryError(f"{path}: the file must hold a table; it is empty.")
    return raw


def _csv(path: Path, raw: bytes) -> tuple["pd.DataFrame", int | None]:
    """Return the cells as text, and the line of the first row."""
    import pandas as pd

    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise TrajectoryError(
            f"{path}:{line}: the text must be encoded in UTF-8; byte"
            f" 0x{raw[error.start]:02x} is not. Save it as UTF-8."
        ) from None
    if "\0" in text:
        line = text.count("\n", 0, text.index("\0")) + 1
        raise TrajectoryError(f"{path}:{line}: the file must be text; got a byte 0.")
    lines = text.splitlines()
    skipped = 0
    while skipped < len(lines) and (not lines[skipped].strip() or lines[skipped][0] == "#"):
        skipped += 1
    head = lines[skipped] if skipped < len(lines) else ""
    if head.count(",") + head.count(";") + head.count("\t") > MAX_COLUMNS:
        raise TrajectoryError(f"{path}:{skipped + 1}: a table has at most {MAX_COLUMNS} columns.")
    separator = next((s for s in (",", ";", "\t") if s in head), r"\s+")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)
            found = pd.read_csv(
                io.StringIO(text), sep=separator, skiprows=skipped, dtype=str,
                keep_default_na=False, skip_blank_lines=False, index_col=False,
            )  # fmt: skip
    except (pd.errors.ParserError, pd.errors.ParserWarning, ValueError) as error:
        number = re.search(r"line (\d+)", str(error))
        line = skipped + int(number[1]) if number else skipped + 1
        raise TrajectoryError(
            f"{path}:{line}: each line must have as many cells as the first one, separated by"
            f" {_separator_name(separator)}; {_short(error)}."
        ) from None
    blank = (found == "").all(axis=1).to_numpy() if len(found.columns) > 1 else None
    if blank is not None and blank.any() and blank[int(np.argmax(blank)) :].all():
        found = found[~blank]  # empty lines at the end
    return found, skipped + 2


def _separator_name(separator: str) -> str:
    return {",": "commas", ";": "semicolons", "\t": "tabs"}.get(separator, "spaces")


def _parquet(path: Path, raw: bytes) -> tuple["pd.DataFrame", int | None]:
    """Return the columns that are recognised; texts stay references to distinct texts."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        names = pq.ParquetFile(pa.BufferReader(raw)).schema_arrow.names
        texts = [name for name in names if _RECOGNISED.get(_key(name)) in TEXTS]
        file = pq.ParquetFile(pa.BufferReader(raw), read_dictionary=texts)
        rows, columns = file.metadata.num_rows, file.metadata.num_columns
        if rows > MAX_ROWS or columns > MAX_COLUMNS:
            raise TrajectoryError(
                f"{path}: a table has at most {MAX_ROWS} rows and {MAX_COLUMNS} columns; got"
                f" {rows} and {columns}. Score a part of it."
            )
        batches, size = [], 0
        for batch in file.iter_batches():
            size += batch.nbytes
            if size > MAX_DECODED:
                raise TrajectoryError(
                    f"{path}: the table must decode to at most {MAX_DECODED >> 20} MiB; it is"
                    " larger. Score a part of it."
                )
            batches.append(batch)
        table = pa.Table.from_batches(batches, file.schema_arrow)
        table.validate(full=True)  # texts that are not UTF-8 fail later otherwise
        _demand_short(path, table, texts)
        return table.to_pandas(ignore_metadata=True), None
    except (pa.ArrowException, OSError, ValueError, OverflowError, KeyError) as error:
        raise TrajectoryError(
            f"{path}: the file must be a Parquet table; {_short(error)}. The option 'format' names"
            " another format."
        ) from None


def _demand_short(path: Path, table: Any, texts: list[str]) -> None:
    """Refuse long names: few of them can be repeated in millions of rows."""
    import pyarrow as pa
    import pyarrow.compute as pc

    for name in texts:
        column = table[name].unify_dictionaries() if table[name].num_chunks else table[name]
        for chunk in column.chunks[:1]:
            values = chunk.dictionary if pa.types.is_dictionary(chunk.type) else chunk
            if not pa.types.is_string(values.type) and not pa.types.is_large_string(values.type):
                continue
            longest = pc.max(pc.utf8_length(values)).as_py() or 0
            if longest > MAX_NAME:
                raise TrajectoryError(
                    f"{path}: {shown(name)} must have at most {MAX_NAME} characters; got {longest}."
                )


def _key(name: str) -> str:
    return name.strip().lower().replace(" ", "_")


_RECOGNISED = {each: name for name, others in NAMES.items() for each in (name, *others)}


def _found(path: Path, held: list[str], columns: Columns) -> dict[str, str]:
    """Return column of benchnav → column of the file."""
    found: dict[str, str] = {}
    for name in held:
        key = _RECOGNISED.get(_key(str(name)))
        if key is not None and key not in columns:
            if key in found:
                raise TrajectoryError(
                    f"{path}:1: one column must be the {key}; both {found[key]!r} and {name!r}"
                    f" are. Choose one by the option 'column': {key}={name}."
                )
            found[key] = name
    for name, theirs in columns.items():
        if theirs not in held:
            raise TrajectoryError(
                f"{path}:1: there must be a column {theirs!r}; the file has {_first_names(held)}."
                f"{did_you_mean(theirs, map(str, held))}"
            )
        found[name] = theirs
    missing = [name for name in ("id", "x", "y") if name not in found]
    if "time" not in found and "frame" not in found:
        missing.append("time")
    if missing:
        one = len(missing) == 1
        named = ["time [s] or frame" if name == "time" else name for name in missing]
        raise TrajectoryError(
            f"{path}:1: there must be {'a column' if one else 'columns'} {listed(named)};"
            f" the file has {_first_names(held)}."
            f" The option 'column' names {'it' if one else 'each'}:"
            f" {', '.join(f'{name}=NAME' for name in missing)}."
        )
    return found


def _first_names(names: list[str]) -> str:
    few = ", ".join(shown(str(name)) for name in names[:10])
    return few if len(names) <= 10 else f"{few} and {len(names) - 10} more"


def _converted(
    path: Path, texts: "pd.DataFrame", line: int | None, found: dict[str, str], unit: float
) -> Table:
    import pandas as pd

    frame: dict[str, Any] = {}
    table = Table(path, texts, None, line)
    for name, theirs in found.items():
        cells = texts[theirs]
        if name in TEXTS:
            frame[name] = cells.astype(str).str.strip()
            bad = (frame[name] == "").to_numpy()
            _demand_none(table, bad, cells, theirs, "a name")
            continue
        numbers = pd.to_numeric(cells, errors="coerce").to_numpy(np.float64)
        with np.errstate(invalid="ignore"):
            bad = ~(np.abs(numbers) <= LARGEST)
        _demand_none(table, bad, cells, theirs, f"a number up to {LARGEST:g}")
        frame[name] = numbers * unit if name in LENGTHS else numbers
    return Table(path, pd.DataFrame(frame), None, line)


def _demand_none(table: Table, bad: Any, cells: Any, column: str, what: str) -> None:
    if bad.any():
        row = int(np.argmax(bad))
        raise TrajectoryError(
            f"{table.place(row)}: {column} must be {what}; got {shown(str(cells.iloc[row]))!r}."
            " Correct or remove the row."
        )


def _short(error: Exception) -> str:
    text = " ".join(str(error).split())
    return (text[:120] if text else type(error).__name__).rstrip(".")
