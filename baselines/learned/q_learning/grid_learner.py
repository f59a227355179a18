"""Tabular Q-learning over cell × move, towards one goal (Watkins & Dayan 1992).

Rewards are minus the metres of a move, without discount, and a move leads to the cell that the map
gives. Values start at minus the distance over empty cells, which is equivalent to shaping by that
potential (Wiewiora 2003, JAIR 19), and are never too low: so the greedy policy tries unknown moves
(Sutton & Barto 2018, section 2.6).
"""

from dataclasses import dataclass

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.kernels import kernel_without_allocation

from .cells import Cells


@dataclass(frozen=True)
class Schooling:
    """The parameters of learning."""

    decisions: int  # moves tried in all
    explore: float  # share of random moves instead of the best
    rate: float  # step size


def learn(
    cells: Cells, ends: IntArray, goal: FloatArray, start: int, schooling: Schooling,
    rng: np.random.Generator,
) -> tuple[FloatArray, IntArray]:  # fmt: skip
    """Return learned values (N, 8), -inf if there is no such move, and the next cells (N,).

    The next cell is that of the best move; -1 in ``ends`` and in cells without a move.

    Args:
        cells: the arena.
        ends: cells in which an episode ends with success.
        goal: (2,) [m].
        start: cell in which every other episode begins; the rest begin anywhere.
        schooling: its parameters.
        rng: of exploration.
    """
    values = first_values(cells, goal)
    values[ends] = 0.0
    link, top = best_moves(values, cells.after, ends)
    usable, count = cells.usable, schooling.decisions // 4 + 1
    begin = rng.choice(usable, count)
    begin[::2] = start
    noise = rng.random(schooling.decisions)
    longest = 4 * (len(usable) + 1)
    episodes(
        values, link, top, cells.after, cells.cost, begin, noise, schooling.explore,
        schooling.rate, longest,
    )  # fmt: skip
    return values, next_cells(link)


def first_values(cells: Cells, goal: FloatArray) -> FloatArray:
    """Return minus the metres (N, 8) of the move and of the path over empty cells to ``goal``.

    A goal cell's centre may lie a side and a half off the goal on either axis.
    """
    x, y = np.maximum(np.abs(cells.centre - goal) - 1.5 * cells.side, 0.0).T
    octile = np.maximum(x, y) + (np.sqrt(2.0) - 1.0) * np.minimum(x, y)
    values = np.full(cells.after.shape, -np.inf)
    _add_moves(octile, cells.after, cells.cost, values)
    return values


@kernel_without_allocation
def _add_moves(octile: FloatArray, after: IntArray, cost: FloatArray, values: FloatArray) -> None:
    """Set ``values`` (N, 8) of all moves that exist."""
    for cell in range(after.shape[0]):
        for move in range(after.shape[1]):
            if after[cell, move] >= 0:
                values[cell, move] = -cost[move] - octile[after[cell, move]]


def best_moves(
    values: FloatArray, after: IntArray, ends: IntArray
) -> tuple[IntArray, FloatArray]:  # fmt: skip
    """Return the link (N,) to the first of the best moves of each cell, and its value (N,).

    A link is 8 × the cell that the move leads to + the move, so that learning reads one number a
    cell; it is negative in ``ends`` and in cells without a move.
    """
    link, top = np.empty(len(values), np.int64), np.empty(len(values))
    _set_best_moves(values, after, link, top)
    link[ends] = -1
    return link, top


def next_cells(link: IntArray) -> IntArray:
    """Return the cells (N,) that links lead to; -1 if they are negative."""
    return link >> 3


@kernel_without_allocation
def _set_best_moves(values: FloatArray, after: IntArray, link: IntArray, top: FloatArray) -> None:
    for cell in range(len(values)):
        move = _best(values, cell)
        link[cell], top[cell] = 8 * after[cell, move] + move, values[cell, move]


@kernel_without_allocation
def episodes(
    values: FloatArray, link: IntArray, top: FloatArray, after: IntArray, cost: FloatArray,
    begin: IntArray, noise: FloatArray, explore: float, rate: float, longest: int,
) -> None:  # fmt: skip
    """Run episodes that begin in ``begin`` (E,), until the ``noise`` (T,) of moves is used up.

    ``link`` (N,) and ``top`` (N,) are those of `best_moves`. They are kept up to date: most moves
    are the best ones and change no value, and read only these small arrays.
    """
    used, decisions = 0, len(noise)
    for e in range(len(begin)):
        cell = begin[e]
        here = link[cell]
        for _ in range(longest):
            if here < 0:
                break
            if used == decisions:
                return
            move, then, old = here & 7, here >> 3, top[cell]
            if noise[used] < explore:
                tried = int(noise[used] / explore * 8)
                if after[cell, tried] >= 0:
                    move, then, old = tried, after[cell, tried], values[cell, tried]
            used += 1
            there = link[then]
            target = top[then] - cost[move]
            value = old + rate * (target - old)
            if value != old:
                values[cell, move] = value
                chosen = _best(values, cell)
                link[cell], top[cell] = 8 * after[cell, chosen] + chosen, values[cell, chosen]
            cell, here = then, there


@kernel_without_allocation
def _best(values: FloatArray, cell: int) -> int:
    """Return the first of the highest values of a cell."""
    best, top = 0, values[cell, 0]
    for m in range(1, 8):
        if values[cell, m] > top:
            best, top = m, values[cell, m]
    return best


@kernel_without_allocation
def follow(after: IntArray, over: BoolArray, start: int) -> int:
    """Return the number of moves from ``start`` to an end by `next_cells`; -1 if it fails."""
    cell = start
    for k in range(len(after)):
        if over[cell]:
            return k
        cell = after[cell]
        if cell < 0:
            return -1
    return -1
