"""The rows of a recording: TrajNet++ ``.ndjson``, and text tables of frame, id, x, y."""

import json
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.config.document import shown
from benchnav.errors import ScenarioError
from benchnav.system.plain_file import read_file

MAX_BYTES = 64 << 20
PLAIN = ("frame", "id", "x", "y")
OBSMAT = ("frame", "id", "x", "_", "y", "_", "_", "_")  # ETH/UCY: the ground plane is x and z
_LARGEST = 1e9  # of any number
_NAMES = {  # of a header, without units
    "frame": "frame", "frame_id": "frame", "frameid": "frame", "frame_number": "frame",
    "id": "id", "persid": "id", "ped_id": "id", "pedestrian_id": "id", "agent_id": "id",
    "track_id": "id", "person_id": "id",
    "x": "x", "pos_x": "x", "y": "y", "pos_y": "y",
}  # fmt: skip
_UNIT = re.compile(r"[/\[(].*$")
_MISSING = {"?", "", "nan", "NaN", "NAN"}


@dataclass(frozen=True, eq=False)
class Rows:
    """N rows of a recording, in the order of the file and in its unit."""

    path: Path
    line: IntArray  # (N,) in the file, from 1; 0: the file has no lines
    frame: FloatArray  # (N,)
    number: IntArray  # (N,) id of the person
    place: FloatArray  # (N, 2) x and y


def read_rows(path: Path, format: str, columns: Sequence[str] | None = None) -> Rows:
    """Return the rows of a file; rows without a place (``?``, NaN or empty) are left out.

    Args:
        path: the file, UTF-8, at most 64 MiB.
        format: "trajnetpp" or "text".
        columns: of a text file, of frame, id, x, y and ``_``; None: those of its header, or by
            their number.

    Raises:
        ScenarioError: the file is not of its format, with ``file:line``.
    """
    found = list(_ndjson(path) if format == "trajnetpp" else _text(path, columns))
    if not found:
        raise ScenarioError(f"{path}:1: the file must hold at least one track.")
    line, frame, number, x, y = zip(*found, strict=True)
    values = np.array([frame, number, x, y], np.float64)
    wrong = ~(np.isfinite(values) & (np.abs(values) < _LARGEST)).all(axis=0)
    wrong |= values[1] != np.rint(values[1])
    if wrong.any():
        k = int(np.argmax(wrong))
        raise ScenarioError(
            f"{path}:{line[k]}: must be four numbers: frame, id, x, y, all below 1e9 and the id"
            f" whole; got {', '.join(f'{v:g}' for v in values[:, k])}."
        )
    return Rows(path, np.array(line), values[0], values[1].astype(np.int64), values[2:].T.copy())


def read_lines(path: Path) -> list[str]:
    """Return the lines of a text file.

    Raises ScenarioError if it is too large, not a regular file, or not UTF-8.
    """
    try:
        raw = read_file(path, MAX_BYTES)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ScenarioError(f"{path}:1: cannot be read: {reason}.") from None
    if len(raw) > MAX_BYTES:
        raise ScenarioError(f"{path}:1: the file must be at most {MAX_BYTES} bytes.")
    try:
        return raw.decode("utf-8-sig").splitlines()
    except ValueError:
        raise ScenarioError(
            f"{path}:1: cannot be read: it must be text in UTF-8. Convert it, or give the format"
            " that it has."
        ) from None


def _ndjson(path: Path) -> Iterator[tuple[int, float, float, float, float]]:
    for line, text in enumerate(read_lines(path), 1):
        if not text.strip():
            continue
        try:
            row = json.loads(text).get("track")
            if row is not None:
                frame, number, x, y = (_number(row[key]) for key in ("f", "p", "x", "y"))
                if not (math.isnan(x) or math.isnan(y)):
                    yield line, frame, number, x, y
        except (ValueError, KeyError, AttributeError, TypeError, RecursionError, OverflowError):
            raise ScenarioError(
                f'{path}:{line}: must be {{"scene": …}} or {{"track": {{"f", "p", "x", "y"}}}};'
                f" got {shown(text)!r}."
            ) from None


def _number(value: Any) -> float:
    if isinstance(value, bool | str):
        raise TypeError
    return math.nan if value is None else float(value)


def _text(
    path: Path, columns: Sequence[str] | None
) -> Iterator[tuple[int, float, float, float, float]]:
    lines = [(n, text) for n, text in enumerate(read_lines(path), 1) if text.strip()]
    at = next((k for k, (_, text) in enumerate(lines) if not _is_comment(text)), len(lines))
    if at == len(lines):
        return
    separator = next((mark for mark in ",;\t" if mark in lines[at][1]), None)
    headers = [_split(text.lstrip(" #%"), None) for _, text in lines[:at]]
    if not _is_number(_split(lines[at][1], separator)[0]):
        headers.append(_split(lines[at][1], separator))
        at += 1
    if at == len(lines):
        return
    width = len(_split(lines[at][1], separator))
    named = columns if columns is not None else _columns(path, lines[at], headers, width)
    where = [list(named).index(name) for name in PLAIN]
    for line, text in lines[at:]:
        if _is_comment(text):
            continue
        words = _split(text, separator)
        try:
            if len(words) != width or width < len(named):
                raise ValueError
            frame, number, x, y = (words[k] for k in where)
            if x not in _MISSING and y not in _MISSING:
                yield line, float(frame), float(number), float(x), float(y)
        except ValueError:
            wanted = "four numbers" if len(named) == 4 else f"{max(width, len(named))} columns"
            raise ScenarioError(
                f"{path}:{line}: must be {wanted}: {', '.join(named)}; got {shown(text)!r}."
            ) from None


def _columns(
    path: Path, first: tuple[int, str], headers: list[list[str]], width: int
) -> Sequence[str]:
    """Return the columns that a header names, or that files with so many columns have."""
    for header in reversed(headers):
        names = [_NAMES.get(_UNIT.sub("", word).strip().lower(), "_") for word in header]
        if len(names) >= width and all(names.count(name) == 1 for name in PLAIN):
            return names[:width]
    if width == len(PLAIN):
        return PLAIN
    if width == len(OBSMAT):
        return OBSMAT
    if width < len(PLAIN):
        raise ScenarioError(
            f"{path}:{first[0]}: must be four numbers: frame, id, x, y; got {shown(first[1])!r}."
        )
    raise ScenarioError(
        f"{path}:{first[0]}: the file has {width} columns and no header that names frame, id, x"
        " and y. Give `columns`, such as [frame, id, x, y, _], where _ is ignored."
    )


def _split(text: str, separator: str | None) -> list[str]:
    return [word.strip() for word in text.split(separator)]


def _is_comment(text: str) -> bool:
    return text.lstrip()[:1] in ("#", "%")


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return word in _MISSING
    return True
