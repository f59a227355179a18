"""Recorded tracks: TrajNet++ ``.ndjson`` and text of four columns (frame, id, x, y)."""

import json
import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.config.document import shown
from benchnav.errors import ScenarioError
from benchnav.scenario.law import RecordedTrack
from benchnav.system.plain_file import read_file

MAX_BYTES = 64 << 20
MAX_TRACKS = 2000
Row = tuple[int, float, int, float, float]  # line, frame, id, x, y


def read_tracks(law: RecordedTrack, folder: Path) -> list[FloatArray]:
    """Return one array (T, 3) of time [s], x, y (as recorded) per id, by ascending id.

    Time 0 is the recording's first frame. Rows with ``?`` in place of numbers are missing
    values and are left out.

    Raises:
        ScenarioError: the file is not of its format, or has not all ids that the law names.
    """
    path = folder / (law.file or "")
    found: dict[int, dict[float, tuple[float, float]]] = {}
    read = _ndjson if law.format == "trajnetpp" else _text
    for line, frame, number, x, y in read(path):
        track = found.setdefault(number, {})
        if frame in track:
            raise ScenarioError(f"{path}:{line}: frame {frame:g} of id {number} is repeated.")
        track[frame] = (x, y)
    if not found:
        raise ScenarioError(f"{path}:1: the file must hold at least one track.")
    first = min(min(track) for track in found.values())
    chosen = sorted(found) if law.ids is None else law.ids
    for number in chosen:
        if number not in found:
            ids = ", ".join(str(n) for n in sorted(found)[:10])
            raise ScenarioError(f"{path}:1: the file must hold id {number}; it has {ids}.")
    if len(chosen) > MAX_TRACKS:
        raise ScenarioError(f"{path}:1: there are more than {MAX_TRACKS} tracks: choose `ids`.")
    step = law.frame_time or 1.0
    return [
        np.array([((f - first) * step, *found[n][f]) for f in sorted(found[n])]) for n in chosen
    ]


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    try:
        raw = read_file(path, MAX_BYTES)
        if len(raw) > MAX_BYTES:
            raise ScenarioError(f"{path}:1: the file must be at most {MAX_BYTES} bytes.")
        text = raw.decode("utf-8-sig")
    except (OSError, ValueError) as error:
        raise ScenarioError(f"{path}:1: cannot be read: {error}.") from None
    for number, line in enumerate(text.splitlines(), 1):
        if line.strip():
            yield number, line


def _ndjson(path: Path) -> Iterator[Row]:
    for line, text in _lines(path):
        try:
            entry = json.loads(text)
            row = entry.get("track")
            if row is not None:
                yield _row(line, row["f"], row["p"], row["x"], row["y"])
        except (ValueError, KeyError, AttributeError, TypeError, RecursionError):
            raise ScenarioError(
                f'{path}:{line}: must be {{"scene": …}} or {{"track": {{"f", "p", "x", "y"}}}};'
                f" got {shown(text)!r}."
            ) from None


def _text(path: Path) -> Iterator[Row]:
    for line, text in _lines(path):
        columns = text.replace(",", " ").split()
        if len(columns) == 4 and "?" in columns:
            continue
        try:
            yield _row(line, *columns)
        except (ValueError, TypeError):
            raise ScenarioError(
                f"{path}:{line}: must be four numbers: frame, id, x, y; got {shown(text)!r}."
            ) from None


def _row(line: int, frame: object, number: object, x: object, y: object) -> Row:
    values = [float(v) for v in (frame, number, x, y)]  # type: ignore[arg-type] # TypeError is caught
    if not all(math.isfinite(v) and abs(v) < 1e9 for v in values) or values[1] != int(values[1]):
        raise ValueError
    return line, values[0], int(values[1]), values[2], values[3]
