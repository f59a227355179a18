"""Tracks: the rows of one episode on one grid of times."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from benchnav.arrays import AnyArray, BoolArray, FloatArray, IntArray
from benchnav.errors import TrajectoryError
from benchnav.scoring.table_file import Table

Gaps = Literal["refuse", "bridge", "split"]
GAPS: tuple[Gaps, ...] = ("refuse", "bridge", "split")
MAX_STATES = 10_000_000  # ids × times, which bounds the memory
MAX_IDS = 5_000
_LOOSE = 0.02  # largest distance of a time from the grid, in steps


@dataclass(frozen=True, eq=False)
class Tracks:
    """Positions of A ids at times 0, dt, … T · dt; an id is present from ``first`` to ``last``."""

    names: tuple[str, ...]  # (A,) ids as in the file
    rows: IntArray  # (A,) index of each track's first row in the table
    dt: float  # [s]
    begin: float  # [s] time of the file at time 0
    place: FloatArray  # (A, T+1, 2) [m], constant before ``first`` and after ``last``
    heading: FloatArray | None  # (A, T+1) [rad]
    first: IntArray  # (A,)
    last: IntArray  # (A,)
    end: FloatArray  # (A,) [s] time of its last row, up to one step before that of ``last``

    def __len__(self) -> int:
        return len(self.names)

    @property
    def together(self) -> bool:
        """Whether all begin at once."""
        return bool((self.first == 0).all())

    def aligned(self) -> "Tracks":
        """Return the same tracks, each shifted to begin at time 0."""
        steps = int((self.last - self.first).max())
        at = np.minimum(self.first[:, None] + np.arange(steps + 1), self.last[:, None])
        each = np.arange(len(self))[:, None]
        heading = None if self.heading is None else self.heading[each, at]
        return replace(
            self, place=self.place[each, at], heading=heading, first=np.zeros_like(self.first),
            last=self.last - self.first, end=self.end - self.first * self.dt,
        )  # fmt: skip


def read_tracks(
    table: Table, rows: IntArray, *, rate: float | None, step: float | None, gaps: Gaps
) -> Tracks:
    """Return the tracks of some rows of a table.

    Args:
        table: the table.
        rows: (N,) the rows of one episode.
        rate: [Hz] of the column frame, if the table has no column time and declares none.
        step: [s] between times; None: that of the table. Positions are interpolated linearly.
        gaps: what happens to an id that is missing for a time: "refuse", "bridge" it by a
            straight line, or "split" the id in two.

    Raises TrajectoryError with the place.
    """
    time = _times(table, rate)[rows]
    names, owner = np.unique(table.frame["id"].to_numpy()[rows].astype(str), return_inverse=True)
    order = np.lexsort((time, owner))
    rows, time, owner = rows[order], time[order], owner[order]
    same = np.diff(owner) == 0
    _demand_different(table, rows, time, same)
    begin = float(time.min())
    time = time - begin
    pause = np.diff(time)[same]
    dt = step or (round(float(np.median(pause)), 9) if len(pause) else 0.0)
    if not dt > 0.0:
        raise TrajectoryError(f"{table.path}: at least one id must have two rows; none has.")
    gap = np.zeros(len(rows), np.bool_)
    gap[1:] = same & (np.diff(time) > (1.5 if step is None else 1.5 * np.median(pause) / dt) * dt)
    if gap.any() and gaps != "bridge":
        if gaps == "refuse":
            raise TrajectoryError(_gap_text(table, rows, time, owner, names, gap, begin))
        owner, names = _split(owner, names, gap)
    first = np.concatenate([[0], np.flatnonzero(np.diff(owner)) + 1])
    if step is None:
        _demand_grid(table, rows, time, owner, dt, begin)
    return _on_grid(table, rows, time, first, tuple(map(str, names)), dt, begin)


def _times(table: Table, rate: float | None) -> FloatArray:
    """Return the time (N,) [s] of every row."""
    time = table.column("time")
    if time is not None:
        return time
    frame, rate = table.column("frame"), table.rate or rate
    if frame is None or rate is None:
        raise TrajectoryError(
            f"{table.path}:1: the time of a frame must be known; the table has no column time."
            " Give the option 'rate', in frames a second."
        )
    return frame / rate


def _demand_different(table: Table, rows: IntArray, time: FloatArray, same: BoolArray) -> None:
    twice = same & (np.diff(time) == 0.0)
    if twice.any():
        k = int(np.argmax(twice))
        row = max(rows[k], rows[k + 1])
        name = table.frame["id"].iloc[row]
        raise TrajectoryError(
            f"{table.place(row)}: an id must have one row at a time; id {name} has two at"
            f" {time[k]:g} s. Remove one."
        )


def _demand_grid(
    table: Table, rows: IntArray, time: FloatArray, owner: IntArray, dt: float, begin: float
) -> None:
    """Refuse times that are not multiples of ``dt``; the last row of an id may be between two."""
    off = np.abs(time / dt - np.rint(time / dt)) > _LOOSE
    off[:-1] &= owner[1:] == owner[:-1]
    off[-1] = False
    if off.any():
        row = int(rows[np.argmax(off)])
        raise TrajectoryError(
            f"{table.place(row)}: times must be multiples of one step, which is {dt:g} s here;"
            f" got {float(time[np.argmax(off)]) + begin:g} s, where the first time is {begin:g} s."
            f" The option 'step' interpolates the tracks at such times: {dt:g}."
        )


def _gap_text(
    table: Table, rows: IntArray, time: FloatArray, owner: IntArray, names: AnyArray,
    gap: BoolArray, begin: float,
) -> str:  # fmt: skip
    k = int(np.argmax(gap))
    more = f" (and {int(gap.sum()) - 1} more gaps)" if gap.sum() > 1 else ""
    return (
        f"{table.place(int(rows[k]))}: a track must have no gap; id {names[owner[k]]} is missing"
        f" from {time[k - 1] + begin:g} s to {time[k] + begin:g} s{more}. The option 'gaps' may be"
        " 'bridge', which joins the ends by a straight line, or 'split', which makes two tracks."
    )


def _split(owner: IntArray, names: AnyArray, gap: BoolArray) -> tuple[IntArray, AnyArray]:
    """Return owners and names of the parts between gaps: ``7``, ``7/2``, ``7/3``."""
    change = gap.copy()
    change[1:] |= np.diff(owner) != 0
    part = np.cumsum(change)
    first = np.concatenate([[0], np.flatnonzero(np.diff(part)) + 1])
    found, count = [], 0
    for k in first:
        count = count + 1 if gap[k] else 1
        found.append(f"{names[owner[k]]}/{count}" if count > 1 else str(names[owner[k]]))
    return part.astype(np.int64), np.array(found)


def _on_grid(
    table: Table, rows: IntArray, time: FloatArray, starts: IntArray, names: tuple[str, ...],
    dt: float, begin: float,
) -> Tracks:  # fmt: skip
    ends = np.append(starts[1:], len(rows))
    first = np.ceil(time[starts] / dt - _LOOSE).astype(np.int64)
    last = np.maximum(np.ceil(time[ends - 1] / dt - _LOOSE).astype(np.int64), first)
    states = int(last.max()) + 1
    if len(names) > MAX_IDS or len(names) * states > MAX_STATES:
        raise TrajectoryError(
            f"{table.path}: an episode has at most {MAX_IDS} ids, and {MAX_STATES} ids × times;"
            f" got {len(names)} ids at {states} times. Score a part of it."
        )
    x, y = (table.frame[name].to_numpy(np.float64)[rows] for name in ("x", "y"))
    heading = table.column("heading")
    place = np.empty((len(names), states, 2))
    turn = None if heading is None else np.empty((len(names), states))
    grid = np.arange(states) * dt
    for a, (low, high) in enumerate(zip(starts, ends, strict=True)):
        own = time[low:high]
        place[a, :, 0] = np.interp(grid, own, x[low:high])
        place[a, :, 1] = np.interp(grid, own, y[low:high])
        place[a, last[a] :] = x[high - 1], y[high - 1]
        if turn is not None and heading is not None:
            turn[a] = np.interp(grid, own, np.unwrap(heading[rows[low:high]]))
    end = np.minimum(time[ends - 1], last * dt)
    end = np.where(last * dt - end <= _LOOSE * dt, last * dt, end)
    return Tracks(names, rows[starts], dt, begin, place, turn, first, last, np.maximum(end, 0.0))
