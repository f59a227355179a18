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
    """Return learned values (N, 8), -inf if there is no such move, and the best moves (N,).

    Args:
        cells: the arena.
        ends: cells in which an episode ends with success.
        goal: (2,) [m].
        start: cell in which every other episode begins; the rest begin anywhere.
        schooling: its parameters.
        rng: of exploration.
    """
    values, over = first_values(cells, goal), np.zeros(len(cells.centre), np.bool_)
    over[ends] = True
    values[over] = 0.0
    best, usable, every = values.argmax(axis=1), cells.usable, np.arange(len(values))
    top, ahead = values[every, best], cells.after[every, best]
    count = schooling.decisions // 4 + 1
    begin = np.where(np.arange(count) % 2 == 0, start, rng.choice(usable, count))
    noise = rng.random(schooling.decisions)
    longest = 4 * (len(usable) + 1)
    episodes(
        values, best, top, ahead, cells.after, cells.cost, over, begin, noise,
        schooling.explore, schooling.rate, longest,
    )  # fmt: skip
    return values, best


def first_values(cells: Cells, goal: FloatArray) -> FloatArray:
    """Return minus the metres (N, 8) of the move and of the path over empty cells to ``goal``.

    A goal cell's centre may lie a side and a half off the goal on either axis.
    """
    x, y = np.maximum(np.abs(cells.centre - goal) - 1.5 * cells.side, 0.0).T
    octile = np.maximum(x, y) + (np.sqrt(2.0) - 1.0) * np.minimum(x, y)
    values: FloatArray = np.where(cells.after >= 0, -cells.cost - octile[cells.after], -np.inf)
    return values


@kernel_without_allocation
def episodes(
    values: FloatArray, best: IntArray, top: FloatArray, ahead: IntArray, after: IntArray,
    cost: FloatArray, over: BoolArray, begin: IntArray, noise: FloatArray, explore: float,
    rate: float, longest: int,
) -> None:  # fmt: skip
    """Run episodes that begin in ``begin`` (E,), until the ``noise`` (T,) of moves is used up.

    ``best`` (N,) is the first of the best moves of each cell, ``top`` (N,) its value and ``ahead``
    (N,) its cell. They are kept up to date: most moves are the best ones and change no value, and
    read only these small arrays.
    """
    used = 0
    for e in range(len(begin)):
        cell = begin[e]
        for _ in range(longest):
            if over[cell]:
                break
            if used == len(noise):
                return
            move, then, old = best[cell], ahead[cell], top[cell]
            if noise[used] < explore:
                tried = int(noise[used] / explore * 8)
                if after[cell, tried] >= 0:
                    move, then, old = tried, after[cell, tried], values[cell, tried]
            used += 1
            target = top[then] - cost[move]
            value = old + rate * (target - old)
            if value != old:
                values[cell, move] = value
                chosen = _best(values, cell)
                best[cell], top[cell] = chosen, values[cell, chosen]
                ahead[cell] = after[cell, chosen]
            cell = then


@kernel_without_allocation
def _best(values: FloatArray, cell: int) -> int:
    """Return the first of the highest values of a cell."""
    best = 0
    for m in range(1, values.shape[1]):
        if values[cell, m] > values[cell, best]:
            best = m
    return best


@kernel_without_allocation
def follow(best: IntArray, after: IntArray, over: BoolArray, start: int) -> int:
    """Return the greedy policy's number of moves from ``start`` to an end; -1 if it fails."""
    cell = start
    for k in range(len(best)):
        if over[cell]:
            return k
        cell = after[cell, best[cell]]
        if cell < 0:
            return -1
    return -1
