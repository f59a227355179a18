"""How far it is to a goal among what stands: what guides the search."""

import heapq
import math
from typing import NamedTuple

import numpy as np

from benchnav.arrays import BoolArray, FloatArray
from benchnav.geometry.capsule_grid import CapsuleGrid, is_clear
from benchnav.kernels import kernel

from .drive import distance
from .scene import Task

SIDE = 0.2  # [m] of a cell


class Reach(NamedTuple):
    """Length [m] of the shortest way to the goal over a grid of nodes; inf: none."""

    length: FloatArray  # (nx, ny)
    x: float  # [m] of node (0, 0)
    y: float


def reach(ground: CapsuleGrid, bounds: tuple[float, float, float, float], task: Task) -> Reach:
    """Ways to the goal of ``task`` within ``bounds`` that its disc may go among what stands."""
    xmin, ymin, xmax, ymax = bounds
    nx, ny = math.ceil((xmax - xmin) / SIDE) + 1, math.ceil((ymax - ymin) / SIDE) + 1
    return Reach(lengths(ground, task, xmin, ymin, nx, ny), xmin, ymin)


@kernel
def lengths(ground: CapsuleGrid, task: Task, x: float, y: float, nx: int, ny: int) -> FloatArray:
    """(nx, ny) [m], by Dijkstra's algorithm over straight motions to the 16 nodes around."""
    found = np.full((nx, ny), math.inf)
    closed = np.zeros((nx, ny), np.bool_)
    heap = [(0.0, 0, 0)]
    heap.pop()
    for i in range(nx):
        for j in range(ny):
            px, py = x + i * SIDE, y + j * SIDE
            away = distance(px, py, task.goal_x, task.goal_y)
            if away <= task.tolerance + SIDE and arrives(ground, task, px, py, away):
                found[i, j] = away
                heapq.heappush(heap, (away, i, j))
    while len(heap) > 0:
        _, i, j = heapq.heappop(heap)
        if not closed[i, j]:
            closed[i, j] = True
            spread(ground, x, y, i, j, found, closed, heap)
    return found


@kernel
def arrives(ground: CapsuleGrid, task: Task, x: float, y: float, away: float) -> bool:
    """Is a node ``away`` [m] from the goal within tolerance, or straight before it?"""
    if away <= task.tolerance:
        return is_clear(ground, x, y, x, y)
    return is_clear(ground, x, y, task.goal_x, task.goal_y)


@kernel
def spread(
    ground: CapsuleGrid, x: float, y: float, i: int, j: int, found: FloatArray,
    closed: BoolArray, heap: list[tuple[float, int, int]],
) -> None:  # fmt: skip
    """Offer node (i, j)'s way to the nodes around it."""
    nx, ny = found.shape
    for di in range(-2, 3):
        for dj in range(-2, 3):
            if max(abs(di), abs(dj)) != 1 and abs(di) + abs(dj) != 3:
                continue
            a, b = i + di, j + dj
            if a < 0 or b < 0 or a >= nx or b >= ny or closed[a, b]:
                continue
            way = found[i, j] + SIDE * math.sqrt(float(di * di + dj * dj))
            if way < found[a, b] and is_clear(
                ground, x + i * SIDE, y + j * SIDE, x + a * SIDE, y + b * SIDE
            ):
                found[a, b] = way
                heapq.heappush(heap, (way, a, b))


@kernel
def to_goal(ways: Reach, x: float, y: float) -> float:
    """Length [m] of the way from (x, y): by the best of the four nodes around it."""
    nx, ny = ways.length.shape
    ci, cj = int((x - ways.x) / SIDE), int((y - ways.y) / SIDE)
    best = math.inf
    for i in range(max(ci, 0), min(ci + 2, nx)):
        for j in range(max(cj, 0), min(cj + 2, ny)):
            to = distance(x, y, ways.x + i * SIDE, ways.y + j * SIDE)
            best = min(best, ways.length[i, j] + to)
    return best
