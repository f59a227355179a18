"""MovingAI grid maps (``.map``) and their queries (``.scen``).

Format: https://movingai.com/benchmarks/formats.html (Sturtevant 2012). The file's
(0, 0) is the upper left cell and its y grows downwards; here y grows upwards: the
cell in file row ``r`` of H has the centre y = (H − 1 − r) + ½ cells.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.errors import MapError
from benchnav.scenario.document import shown
from benchnav.scenario.importers.grid import MAX_CELLS, Occupancy, check_size, read_bytes

FREE = ".GS"
BLOCKED = "@OTW"  # water too: nothing here swims
MAX_QUERIES = 100_000
_MAX_BYTES = MAX_CELLS + (1 << 20)
_HEADER = "the four header lines are `type octile`, `height H`, `width W`, `map`"


@dataclass(frozen=True, eq=False)
class Queries:
    """The rows of a ``.scen`` file, y already turned upwards."""

    bucket: IntArray  # (Q,)
    start: IntArray  # (Q, 2) cell (column, row), row 0 at the bottom
    goal: IntArray  # (Q, 2)
    length: FloatArray  # (Q,) published optimal octile length, in cells


def read_map(path: Path | str, cell: float = 1.0) -> Occupancy:
    """The map in ``path`` with its lower left corner at the origin; ``cell`` [m] a cell.

    Raises:
        MapError: it is not such a map.
    """
    path = Path(path)
    lines = _lines(path, "a MovingAI map")
    width, height = _header(path, lines)
    rows = lines[4:]
    while rows and not rows[-1].strip():
        rows.pop()
    if len(rows) != height:
        raise MapError(
            f"{path}:{5 + min(len(rows), height)}: the map must have the {height} rows that "
            f"line 2 or 3 declares; got {len(rows)}."
        )
    for number, row in enumerate(rows, 5):
        if len(row) != width:
            raise MapError(f"{path}:{number}: a row must have {width} cells; got {len(row)}.")
    letters = np.frombuffer("".join(rows).encode("latin-1"), np.uint8).reshape(height, width)
    free = np.isin(letters, np.frombuffer(FREE.encode(), np.uint8))
    blocked = np.isin(letters, np.frombuffer(BLOCKED.encode(), np.uint8))
    if not np.all(free | blocked):
        row, column = np.argwhere(~(free | blocked))[0]
        raise MapError(
            f"{path}:{row + 5}: column {column + 1} must be one of {' '.join(FREE + BLOCKED)}; "
            f"got {chr(letters[row, column])!r}."
        )
    upright = np.ascontiguousarray(blocked[::-1])
    return Occupancy(upright, np.zeros_like(upright), cell, (0.0, 0.0, 0.0))


def read_scen(path: Path | str, map_path: Path | str, occupancy: Occupancy) -> Queries:
    """The queries of ``path`` on the map in ``map_path``, which was read as ``occupancy``.

    Raises:
        MapError: it is no such file, or belongs to another map, or starts or ends where
            the map is blocked.
    """
    path = Path(path)
    lines = _lines(path, "a MovingAI .scen file")
    first = lines[0].split()
    if len(first) != 2 or first[0] != "version" or first[1] not in {"1", "1.0"}:
        raise MapError(f"{path}:1: the first line must be `version 1`; got {_got(lines[0])}.")
    rows = [(n, line) for n, line in enumerate(lines[1:], 2) if line.strip()]
    if not rows:
        raise MapError(f"{path}:2: the file must hold at least one query; got none.")
    if len(rows) > MAX_QUERIES:
        raise MapError(f"{path}:1: at most {MAX_QUERIES} queries are read; got {len(rows)}.")
    parsed = [_query(f"{path}:{n}", line, Path(map_path).name, occupancy) for n, line in rows]
    bucket, start, goal, length = zip(*parsed, strict=True)
    return Queries(np.array(bucket), np.array(start), np.array(goal), np.array(length))


def _lines(path: Path, what: str) -> list[str]:
    text = read_bytes(path, _MAX_BYTES, what).decode("latin-1")
    return text.replace("\r\n", "\n").replace("\r", "").split("\n")


def _header(path: Path, lines: list[str]) -> tuple[int, int]:
    """(width, height)"""
    words = [line.split() for line in lines[:4]]
    words += [[] for _ in range(4 - len(words))]
    if words[0] != ["type", "octile"]:
        raise MapError(f"{path}:1: must be `type octile`; got {_got(lines[0])}. {_HEADER}.")
    size: dict[str, int] = {}
    for number in (1, 2):
        pair = words[number]
        known = len(pair) == 2 and pair[0] in {"height", "width"} and pair[0] not in size
        if not known or not _is_count(pair[1]):
            got = _got(lines[number]) if number < len(lines) else "the end of the file"
            raise MapError(f"{path}:{number + 1}: must say height or width; got {got}. {_HEADER}.")
        size[pair[0]] = int(pair[1])
    check_size(f"{path}:2", size["width"], size["height"])
    if words[3] != ["map"]:
        got = _got(lines[3]) if len(lines) > 3 else "the end of the file"
        raise MapError(f"{path}:4: must be `map`; got {got}. {_HEADER}.")
    return size["width"], size["height"]


def _query(
    where: str, line: str, map_name: str, occupancy: Occupancy
) -> tuple[int, tuple[int, int], tuple[int, int], float]:
    fields = line.split("\t")
    if len(fields) != 9:
        raise MapError(f"{where}: a query must have 9 fields between tabs; got {len(fields)}.")
    named = fields[1].replace("\\", "/").rsplit("/", 1)[-1]
    if named != map_name:
        raise MapError(f"{where}: the query must be about {map_name}; got {_got(named)}.")
    numbers = [fields[0], *fields[2:8]]
    if not all(_is_count(n.strip()) for n in numbers):
        raise MapError(f"{where}: fields 1 and 3 to 8 must be whole numbers ≥ 0; got {_got(line)}.")
    bucket, width, height, sx, sy, gx, gy = (int(n) for n in numbers)
    high, wide = occupancy.blocked.shape
    if (width, height) != (wide, high):
        raise MapError(
            f"{where}: width and height must be those of the map, {wide} and {high}; "
            f"got {width} and {height}."
        )
    length = _length(where, fields[8])
    start, goal = (sx, high - 1 - sy), (gx, high - 1 - gy)
    for what, (column, row) in (("start", start), ("goal", goal)):
        if column >= wide or not 0 <= row < high or occupancy.blocked[row, column]:
            raise MapError(f"{where}: the {what} must be a free cell of the map; got {_got(line)}.")
    return bucket, start, goal, length


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
