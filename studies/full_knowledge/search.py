"""Search in space and time: the commands that lead one agent to its goal.

Weighted A* (I. Pohl, "Heuristic search viewed as path finding in a graph", Artificial
Intelligence 1, 1970) over a lattice of twists, one a decision. Of states that share a
cell of place, heading and time only the first is kept.
"""

import heapq
import math
from typing import NamedTuple

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.geometry.capsule_grid import CapsuleGrid
from benchnav.kernels import kernel

from .drive import ARRIVED, HIT, drive
from .reach import SIDE, Reach, to_goal
from .scene import Movers, Task, Traffic

HEADINGS = 25  # cells of heading: about a quarter of a radian each


class Effort(NamedTuple):
    """How a search is done."""

    nodes: int = 60_000  # that it may make before it gives up
    cell: float = 0.2  # [m] side of a cell of place
    weight: float = 1.5  # of the way that is left against the time that has passed
    speeds: int = 3  # from 0 to the greatest
    turns: int = 5  # turn rates from limit to limit


@kernel
def search(
    task: Task, ground: CapsuleGrid, movers: Movers, traffic: Traffic, ways: Reach, effort: Effort
) -> FloatArray:
    """(T, 2) twists [m/s, rad/s] that reach the goal, the last one within it; (0, 2): not found."""
    state = np.empty((effort.nodes, 3))  # x [m], y [m], heading [rad]
    origin = np.empty((effort.nodes, 3), np.int64)  # parent, command, step
    seen = np.zeros(power_of_two(4 * effort.nodes), np.int64)
    put(state, origin, 0, (task.x, task.y, task.heading), (-1, 0, 0))
    heap = [(0.0, 0, 0)]  # cost [s], minus the step: of equals the deepest first, node
    count, twists = 1, effort.speeds * effort.turns
    while len(heap) > 0 and count + twists <= effort.nodes:
        _, _, node = heapq.heappop(heap)
        step = origin[node, 2] + 1
        if step > task.steps:
            continue
        for command in range(twists):
            v, w = twist(task, effort, command)
            outcome, x, y, heading = drive(
                task, ground, movers, traffic, state[node, 0], state[node, 1], state[node, 2],
                step - 1, v, w,
            )  # fmt: skip
            if outcome == HIT:
                continue
            if outcome == ARRIVED:
                put(state, origin, count, (x, y, heading), (node, command, step))
                return commands_to(task, effort, origin, count)
            cost = cost_of(task, ways, effort.weight, x, y, step)
            if cost < math.inf and insert(seen, key(effort.cell, x, y, heading, step)):
                put(state, origin, count, (x, y, heading), (node, command, step))
                heapq.heappush(heap, (cost, -step, count))
                count += 1
    return np.zeros((0, 2))


@kernel
def put(
    state: FloatArray, origin: IntArray, node: int, pose: tuple[float, float, float],
    link: tuple[int, int, int],
) -> None:  # fmt: skip
    """Write a node: its pose (x, y, heading) and where it comes from (parent, command, step)."""
    for k in range(3):
        state[node, k], origin[node, k] = pose[k], link[k]


@kernel
def cost_of(task: Task, ways: Reach, weight: float, x: float, y: float, step: int) -> float:
    """Time passed and weighted time left [s] at (x, y); inf where the horizon is too near."""
    dt = task.h * task.substeps
    left = max(to_goal(ways, x, y) - task.tolerance - SIDE, 0.0) / task.max_speed
    if left > (task.steps - step) * dt * 1.1:  # ways over the grid are longer by a few %
        return math.inf
    return step * dt + weight * left


@kernel
def twist(task: Task, effort: Effort, command: int) -> tuple[float, float]:
    """(v [m/s], w [rad/s]) of a command; the limits of the body are among them."""
    v = task.max_speed * (command // effort.turns) / (effort.speeds - 1)
    half = (effort.turns - 1) / 2
    return v, task.max_turn_rate * (command % effort.turns - half) / half


@kernel
def commands_to(task: Task, effort: Effort, origin: IntArray, last: int) -> FloatArray:
    """(T, 2) twists along the way to node ``last``."""
    commands = np.empty((origin[last, 2], 2))
    node = last
    while origin[node, 0] >= 0:
        v, w = twist(task, effort, origin[node, 1])
        commands[origin[node, 2] - 1, 0], commands[origin[node, 2] - 1, 1] = v, w
        node = origin[node, 0]
    return commands


@kernel
def key(cell: float, x: float, y: float, heading: float, step: int) -> int:
    """A number ≥ 1 for the cell of a state."""
    i, j = math.floor(x / cell) + 4096, math.floor(y / cell) + 4096
    k = math.floor(heading * HEADINGS / (2.0 * math.pi) + 0.5) % HEADINGS
    return 1 + ((step * HEADINGS + k) * 8192 + i) * 8192 + j


@kernel
def insert(seen: IntArray, value: int) -> bool:
    """Put ``value`` ≥ 1 into the hash table; False where it is there already."""
    mask = len(seen) - 1
    at = ((value ^ (value >> 21)) * 2654435761 >> 7) & mask
    while seen[at] != 0:
        if seen[at] == value:
            return False
        at = (at + 1) & mask
    seen[at] = value
    return True


@kernel
def power_of_two(least: int) -> int:
    """The smallest power of two that is ≥ ``least``."""
    size = 1
    while size < least:
        size *= 2
    return size
