"""MovingAI grid maps (``.map``) and their queries (``.scen``).

Format: https://movingai.com/benchmarks/formats.html (Sturtevant 2012). The file's
(0, 0) is the upper left cell and its y grows downwards; here y grows upwards: the
cell in file row ``r`` of H has the centre y = (H − 1 − r) + ½ cells.
"""

import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.config.document import shown
from benchnav.errors import MapError
from benchnav.scenario.importers.grid import MAX_CELLS, Occupancy, check_size, read_bytes

FREE = ".GS"
BLOCKED = "@OTW"  # includes water: agents cannot swim
_MAX_BYTES = MAX_CELLS + (1 << 20)
_LINE_END = re.compile(r"\r\n|\r|\n")
_HEADER = "the four header lines are `type octile`, `height H`, `width W`, `map`"

Lines = list[tuple[int, str]]  # (number in the file from 1, text without surrounding spaces)


@dataclass(frozen=True, eq=False)
class Queries:
    """The rows of a ``.scen`` file, with y upwards."""

    bucket: IntArray  # (Q,)
    start: IntArray  # (Q, 2) cell (column, row), row 0 at the bottom
    goal: IntArray  # (Q, 2)
    length: FloatArray  # (Q,) published optimal octile length, in cells
    left_out: tuple[str, ...] = ()  # the problem of each row that cannot be used


def read_map(path: Path | str, cell: float = 1.0) -> Occupancy:
    """Return the map in ``path``, its lower left corner at the origin; ``cell`` [m] is a side.

    Like the original reader, ignore blank lines, spaces around a row and letter case.

    Raises:
        MapError: it is not such a map.
    """
    path = Path(path)
    lines = _lines(path, "a MovingAI map")
    width, height = _header(path, lines)
    rows = lines[4:]
    if len(rows) != height:
        at = rows[height][0] if len(rows) > height else lines[-1][0] + 1
        raise MapError(
            f"{path}:{at}: the map must have the {height} rows that "
            f"line 2 or 3 declares; got {len(rows)}."
        )
    for number, row in rows:
        if len(row) != width:
            raise MapError(f"{path}:{number}: a row must have {width} cells; got {len(row)}.")
    letters = np.frombuffer("".join(row for _, row in rows).encode("latin-1"), np.uint8)
    letters = letters.reshape(height, width)
    free, blocked = _any_case(letters, FREE), _any_case(letters, BLOCKED)
    if not np.all(free | blocked):
        row_index, column = np.argwhere(~(free | blocked))[0]
        raise MapError(
            f"{path}:{rows[row_index][0]}: column {column + 1} must be one of "
            f"{' '.join(FREE + BLOCKED)}; got {chr(letters[row_index, column])!r}."
        )
    upright = np.ascontiguousarray(blocked[::-1])
    return Occupancy(upright, np.zeros_like(upright), cell, (0.0, 0.0, 0.0))


def read_scen(path: Path | str, map_path: Path | str, occupancy: Occupancy) -> Queries:
    """Return the queries of ``path`` on the map in ``map_path``, which was read as ``occupancy``.

    Fields are separated by spaces or tabs. As in the original reader, a file without a
    version has rows with or without width and height. Rows that cannot be used, or that
    are about another map, are left out.

    Raises:
        MapError: no row can be used; the message is about the first.
    """
    path = Path(path)
    lines = _lines(path, "a MovingAI .scen file")
    versioned, rows = _version(path, lines)
    parsed, left_out = [], []
    for number, line in rows:
        try:
            parsed.append(
                _query(f"{path}:{number}", line, versioned, Path(map_path).name, occupancy)
            )
        except MapError as error:
            left_out.append(str(error))
    if not parsed:
        raise MapError(left_out[0])
    bucket, start, goal, length = zip(*parsed, strict=True)
    return Queries(
        np.array(bucket), np.array(start), np.array(goal), np.array(length), tuple(left_out)
    )


def _lines(path: Path, subject: str) -> Lines:
    """Return the lines that are not blank."""
    text = read_bytes(path, _MAX_BYTES, subject).removeprefix(b"\xef\xbb\xbf").decode("latin-1")
    numbered = enumerate(map(str.strip, _LINE_END.split(text)), 1)
    return [(number, line) for number, line in numbered if line]


def _any_case(letters: NDArray[np.uint8], of: str) -> BoolArray:
    return np.isin(letters, np.frombuffer((of + of.lower()).encode(), np.uint8))


def _header(path: Path, lines: Lines) -> tuple[int, int]:
    """Return (width, height)."""
    end = lines[-1][0] + 1 if lines else 1
    numbers, texts = zip(*(*lines[:4], *[(end, "")] * 4), strict=True)
    got = [_got(text) if i < len(lines) else "the end of the file" for i, text in enumerate(texts)]
    if texts[0].split() != ["type", "octile"]:
        raise MapError(f"{path}:{numbers[0]}: must be `type octile`; got {got[0]}. {_HEADER}.")
    size: dict[str, int] = {}
    for i in (1, 2):
        pair = texts[i].split()
        known = len(pair) == 2 and pair[0] in {"height", "width"} and pair[0] not in size
        if not known or not _is_count(pair[1]):
            raise MapError(
                f"{path}:{numbers[i]}: must give height or width; got {got[i]}. {_HEADER}."
            )
        size[pair[0]] = int(pair[1])
    check_size(f"{path}:{numbers[1]}", size["width"], size["height"])
    if texts[3] != "map":
        raise MapError(f"{path}:{numbers[3]}: must be `map`; got {got[3]}. {_HEADER}.")
    return size["width"], size["height"]


def _version(path: Path, lines: Lines) -> tuple[bool, Lines]:
    """Return whether the file is of version 1, and its rows."""
    number, first = lines[0] if lines else (1, "")
    words = first.split()
    if first and words[0].lower() != "version":
        return False, lines
    try:
        version = float(words[1]) if len(words) == 2 else math.nan
    except ValueError:
        version = math.nan
    if version not in {0.0, 1.0}:
        raise MapError(f"{path}:{number}: the first line must be `version 1`; got {_got(first)}.")
    if len(lines) == 1:
        raise MapError(f"{path}:{number + 1}: the file must hold at least one query; got none.")
    return version == 1.0, lines[1:]


def _query(
    where: str, line: str, versioned: bool, map_name: str, occupancy: Occupancy
) -> tuple[int, tuple[int, int], tuple[int, int], float]:
    fields = _fields(where, line, versioned)
    if not _same_map(fields[1], map_name):
        raise MapError(
            f"{where}: the query must be about {map_name}; got {_got(fields[1])}."
            " A map's file must have its published name."
        )
    bucket, *size, sx, sy, gx, gy = (
        _count(where, fields, i) for i in range(len(fields) - 1) if i != 1
    )
    high, wide = occupancy.blocked.shape
    if size and size != [wide, high]:
        raise MapError(
            f"{where}: width and height must be those of the map, {wide} and {high}; "
            f"got {size[0]} and {size[1]}. The file is for a map of that size."
        )
    length = _length(where, fields[-1])
    start, goal = (sx, high - 1 - sy), (gx, high - 1 - gy)
    for end, (column, row) in (("start", start), ("goal", goal)):
        if column >= wide or not 0 <= row < high or occupancy.blocked[row, column]:
            raise MapError(f"{where}: the {end} must be a free cell of the map; got {_got(line)}.")
    return bucket, start, goal, length


def _fields(where: str, line: str, versioned: bool) -> list[str]:
    """Return bucket, map, (width, height,) start, goal, length; a map name may have spaces."""
    tabbed = [field.strip() for field in line.split("\t")]
    words = tabbed if len(tabbed) in ({9} if versioned else {7, 9}) else line.split()
    count = 7 if len(words) == 7 and not versioned else 9
    if len(words) < count:
        raise MapError(
            f"{where}: a query must have 9 fields between tabs or spaces; got {len(words)}."
        )
    tail = len(words) - count + 2
    return [words[0], " ".join(words[1:tail]), *words[tail:]]


def _same_map(named: str, map_name: str) -> bool:
    """Whether a row names the map, in any folder and letter case."""
    base = named.replace("\\", "/").rsplit("/", 1)[-1]
    return base.lower().removesuffix(".map") == map_name.lower().removesuffix(".map")


def _count(where: str, fields: list[str], index: int) -> int:
    try:
        number = float(fields[index])
    except ValueError:
        number = math.nan
    if not 0.0 <= number < 1e9 or not number.is_integer():
        raise MapError(
            f"{where}: all fields but the map and the length must be whole numbers ≥ 0;"
            f" field {index + 1} is {_got(fields[index])}."
        )
    return int(number)


def _length(where: str, text: str) -> float:
    try:
        length = float(text)
    except ValueError:
        length = math.nan
    if not 0.0 <= length < math.inf:
        raise MapError(f"{where}: the optimal length must be a number ≥ 0; got {_got(text)}.")
    return length


def _is_count(text: str) -> bool:
    return text.isascii() and text.isdigit() and len(text) <= 9


def _got(text: str) -> str:
    return repr(shown(text)) if text.strip() else "nothing"
