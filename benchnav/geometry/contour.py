"""Outlines of the blocked cells of a grid, as rectilinear loops.

Blocked cells that touch at a corner are connected: no path passes between
them. Every loop has the blocked cells on its left, and no vertex on a straight
line.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from benchnav.arrays import AnyArray, BoolArray, FloatArray, IntArray

_EIGHT = np.ones((3, 3), dtype=np.int8)


@dataclass(frozen=True, eq=False)
class Outline:
    """The loops of one connected set of blocked cells."""

    loops: tuple[FloatArray, ...]  # each (V, 2) in cells, from the grid's lower left corner


class _Runs(NamedTuple):
    """Maximal straight pieces between blocked and free cells, the blocked ones on the left."""

    tail: IntArray  # (N, 2) lattice points (x, y)
    head: IntArray  # (N, 2)
    label: IntArray  # (N,) component of the blocked cells beside it
    heading: IntArray  # (N,) 0 east, 1 north, 2 west, 3 south


def outlines(blocked: BoolArray) -> tuple[Outline, ...]:
    """Return an outline per 8-connected set of blocked cells of a (H, W) grid, row 0 at the bottom.

    The outside of the grid counts as blocked and comes first. Its outline consists of
    the inner boundary only, so its loops run clockwise around the free cells. It
    is omitted if no cell is free.
    """
    from scipy import ndimage

    padded = np.pad(blocked, 1, constant_values=True)
    label, count = ndimage.label(padded, structure=_EIGHT)
    runs = _runs(label)
    found: list[list[FloatArray]] = [[] for _ in range(count + 1)]
    following = _following(runs)
    for loop in _cycles(following):
        found[runs.label[loop[0]]].append(runs.tail[loop].astype(np.float64) - 1.0)
    outside = int(label[0, 0])
    order = [outside, *(k for k in range(1, count + 1) if k != outside)]
    return tuple(Outline(tuple(found[k])) for k in order if found[k])


def _runs(label: AnyArray) -> _Runs:
    """Return runs along lattice lines: between rows (horizontal), then columns (vertical)."""
    east = _line_runs(label)
    north = _line_runs(label.T)
    line, start, end, above, component = (np.concatenate([east[k], north[k]]) for k in range(5))
    vertical = np.arange(len(line)) >= len(east[0])
    # blocked cells above a horizontal run: it heads east; right of a vertical run: south
    forward = above ^ vertical
    begin, finish = np.where(forward, start, end), np.where(forward, end, start)
    tail = np.where(vertical[:, None], np.stack([line, begin], 1), np.stack([begin, line], 1))
    head = np.where(vertical[:, None], np.stack([line, finish], 1), np.stack([finish, line], 1))
    heading = np.where(forward, 0, 2) + vertical
    return _Runs(tail, head, component, heading)


def _line_runs(label: AnyArray) -> tuple[IntArray, IntArray, IntArray, BoolArray, IntArray]:
    """Return (line, first, last, blocked beyond the line, component) of the runs along axis 1."""
    blocked = label > 0
    side = blocked[1:].astype(np.int8) - blocked[:-1].astype(np.int8)  # line k is between k, k + 1
    step = np.pad(side, ((0, 0), (1, 1)))
    begins = (step[:, 1:] != step[:, :-1]) & (step[:, 1:] != 0)
    ends = (step[:, 1:] != step[:, :-1]) & (step[:, :-1] != 0)
    line, first = np.nonzero(begins)
    last = np.nonzero(ends)[1]
    above = side[line, first] > 0
    component = label[line + above, first]
    return line + 1, first, last, above, component.astype(np.int64)


def _following(runs: _Runs) -> IntArray:
    """Return the run (N,) that continues each run; at a corner of two cells, the right-hand one."""
    width = int(runs.head.max(initial=0)) + 1

    def key(point: IntArray, heading: IntArray) -> IntArray:
        return np.asarray((point[:, 1] * width + point[:, 0]) * 4 + heading)

    starts = key(runs.tail, runs.heading)
    order = np.argsort(starts)
    ranked = starts[order]
    right = key(runs.head, (runs.heading + 3) % 4)
    at = np.minimum(np.searchsorted(ranked, right), max(len(ranked) - 1, 0))
    left = key(runs.head, (runs.heading + 1) % 4)
    wanted = np.where(ranked[at] == right, right, left) if len(ranked) else right
    return np.asarray(order[np.searchsorted(ranked, wanted)])


def _cycles(following: IntArray) -> list[IntArray]:
    """Return the cycles of a permutation, each from its smallest element."""
    after = following.tolist()
    seen = [False] * len(after)
    cycles = []
    for first in range(len(after)):
        if seen[first]:
            continue
        cycle, at = [], first
        while not seen[at]:
            seen[at] = True
            cycle.append(at)
            at = after[at]
        cycles.append(np.array(cycle))
    return cycles
