"""Tabular Q-learning over cell × move, towards one goal (Watkins & Dayan 1992).

Rewards are minus the metres of a move, without discount, and a move leads to the cell that the map
gives. Values start at minus the distance over empty cells, which is equivalent to shaping by that
potential (Wiewiora 2003, JAIR 19), and are never too low: so the greedy policy tries unknown moves
(Sutton & Barto 2018, section 2.6).
"""

from dataclasses import dataclass

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.kernels import kernel

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
) -> FloatArray:  # fmt: skip
    """Return learned values (N, 8); -inf if there is no such move.

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
    usable = np.flatnonzero((cells.after >= 0).any(axis=1))
    count = schooling.decisions // 4 + 1
    begin = np.where(np.arange(count) % 2 == 0, start, rng.choice(usable, count))
    noise = rng.random(schooling.decisions)
    longest = 4 * (len(usable) + 1)
    episodes(
        values,
        cells.after,
        cells.cost,
        over,
        begin,
        noise,
        schooling.explore,
        schooling.rate,
        longest,
    )
    return values


def first_values(cells: Cells, goal: FloatArray) -> FloatArray:
    """Return minus the metres (N, 8) of the move and of the path over empty cells to ``goal``.

    A goal cell's centre may lie a side and a half off the goal on either axis.
    """
    away = np.maximum(np.abs(cells.centre - goal) - 1.5 * cells.side, 0.0)
    octile = away.max(axis=1) + (np.sqrt(2.0) - 1.0) * away.min(axis=1)
    values: FloatArray = np.where(cells.after >= 0, -cells.cost - octile[cells.after], -np.inf)
    return values


@kernel
def episodes(
    values: FloatArray, after: IntArray, cost: FloatArray, over: BoolArray, begin: IntArray,
    noise: FloatArray, explore: float, rate: float, longest: int,
) -> None:  # fmt: skip
    """Run episodes that begin in ``begin`` (E,), until the ``noise`` (T,) of moves is used up."""
    used = 0
    for e in range(len(begin)):
        cell = begin[e]
        for _ in range(longest):
            if over[cell]:
                break
            if used == len(noise):
                return
            move = _best(values[cell])
            if noise[used] < explore:
                tried = int(noise[used] / explore * 8)
                move = tried if after[cell, tried] >= 0 else move
            used += 1
            then = after[cell, move]
            target = values[then, _best(values[then])] - cost[move]
            values[cell, move] += rate * (target - values[cell, move])
            cell = then


@kernel
def _best(values: FloatArray) -> int:
    """Return the first of the highest values."""
    best = 0
    for m in range(1, len(values)):
        if values[m] > values[best]:
            best = m
    return best


@kernel
def follow(values: FloatArray, after: IntArray, over: BoolArray, start: int) -> int:
    """Return the greedy policy's number of moves from ``start`` to an end; -1 if it fails."""
    cell = start
    for k in range(len(values)):
        if over[cell]:
            return k
        cell = after[cell, _best(values[cell])]
        if cell < 0:
            return -1
    return -1
