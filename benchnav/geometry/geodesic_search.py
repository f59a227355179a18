"""A* search over tangents and arcs.

Nodes are points where a tangent touches an arc. The neighbours of a node are the other
end of its tangent, and the nodes before and after it on its arc. The search starts and ends
with links (rows of arc, angle, length): straight motions from the start or to the
goal that touch arcs between nodes.
"""

import math
from typing import NamedTuple

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.geometry.free_arc import TWO_PI, Arcs
from benchnav.geometry.heap import pop, push
from benchnav.kernels import kernel


class Tangents(NamedTuple):
    """Nodes sorted by arc, then by angle."""

    first: IntArray  # (arcs + 1,) first node of each arc
    arc: IntArray  # (N,)
    angle: FloatArray  # (N,) [rad] from the arc's beginning
    point: FloatArray  # (N, 2) [m]
    other: IntArray  # (N,) node at the tangent's other end
    length: FloatArray  # (N,) [m] of the tangent


class Found(NamedTuple):
    """A shortest path: length [m] (inf: none), first and last link, nodes from start to goal."""

    length: float
    first: int
    last: int
    nodes: IntArray


def tangents(arcs: Arcs, rows: FloatArray) -> Tangents:
    """Return the graph of bitangents (M, 5); a full circle's end is joined to its beginning."""
    arc, angle, length = _nodes(arcs, rows)
    found: Tangents = _sorted_nodes(arcs, arc, angle, length, np.lexsort((angle, arc)))
    return found


@kernel
def _nodes(arcs: Arcs, rows: FloatArray) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return arc, angle and tangent's length (N,) of all first ends, and then of all other ends."""
    count = len(rows)
    pairs = count
    for k in range(len(arcs.width)):
        pairs += arcs.width[k] >= TWO_PI
    arc, angle, length = np.empty(2 * pairs, np.int64), np.empty(2 * pairs), np.empty(2 * pairs)
    for n in range(count):
        arc[n], angle[n], length[n] = int(rows[n, 0]), rows[n, 1], rows[n, 4]
        m = n + pairs
        arc[m], angle[m], length[m] = int(rows[n, 2]), rows[n, 3], rows[n, 4]
    for k in range(len(arcs.width)):
        if arcs.width[k] >= TWO_PI:
            m = count + pairs
            arc[count], angle[count], length[count] = k, 0.0, 0.0
            arc[m], angle[m], length[m] = k, TWO_PI, 0.0
            count += 1
    return arc, angle, length


@kernel
def _sorted_nodes(
    arcs: Arcs, arc: IntArray, angle: FloatArray, length: FloatArray, order: IntArray
) -> Tangents:
    """Return the graph of nodes (N,) in ``order``; node n and node n ± N / 2 share a tangent."""
    count = len(order)
    rank, other, first = np.empty(count, np.int64), np.empty(count, np.int64), 0
    for n in range(count):
        rank[order[n]] = n
    starts, point = np.zeros(len(arcs.radius) + 1, np.int64), np.empty((count, 2))
    for n in range(count):
        k = arc[order[n]]
        while first <= k:
            starts[first] = n
            first += 1
        turn, radius = arcs.low[k] + angle[order[n]], arcs.radius[k]
        point[n, 0] = arcs.center[k, 0] + math.cos(turn) * radius
        point[n, 1] = arcs.center[k, 1] + math.sin(turn) * radius
        other[n] = rank[(order[n] + count // 2) % count]
    starts[first:] = count
    return Tangents(starts, arc[order], angle[order], point, other, length[order])


@kernel
def search(
    arcs: Arcs, graph: Tangents, leave: FloatArray, arrive: FloatArray,
    goal_x: float, goal_y: float, tolerance: float,
) -> Found:  # fmt: skip
    """Return the shortest path that leaves by one link (·, 3) and arrives by another."""
    size = len(graph.arc)
    best, first, last = _on_one_arc(arcs, leave, arrive)
    node = -1
    ending, ending_link = _beside(arcs, graph, arrive)
    cost, link = _beside(arcs, graph, leave)
    parent = -2 - link  # -1: none; below that: a link from the start
    key, item = np.empty(4 * size + 1), np.empty(4 * size + 1, np.int64)
    waiting = 0
    for n in range(size):
        if link[n] >= 0:
            bound = cost[n] + _lower_bound(graph, n, goal_x, goal_y, tolerance)
            waiting = push(key, item, waiting, bound, n)
    done = np.zeros(size, np.bool_)
    while waiting > 0 and key[0] < best:
        n = item[0]
        waiting = pop(key, item, waiting)
        if done[n]:
            continue
        done[n] = True
        if cost[n] + ending[n] < best:
            best, last, node = cost[n] + ending[n], ending_link[n], n
        k = graph.arc[n]
        for way in range(-1, 2):  # the node before on the arc, across the tangent, the node after
            m = n + way if way != 0 else graph.other[n]
            if way != 0 and (m < graph.first[k] or m >= graph.first[k + 1]):
                continue
            turn = graph.angle[m] - graph.angle[n]
            through = cost[n] + (graph.length[n] if way == 0 else arcs.radius[k] * abs(turn))
            if through < cost[m]:
                cost[m], parent[m] = through, n
                bound = through + _lower_bound(graph, m, goal_x, goal_y, tolerance)
                waiting = push(key, item, waiting, bound, m)
    return _found(parent, best, first, last, node)


@kernel
def _on_one_arc(arcs: Arcs, leave: FloatArray, arrive: FloatArray) -> tuple[float, int, int]:
    """Return the shortest path over one arc between two links: (length, first, last); inf: none."""
    best, first, last = math.inf, -1, -1
    for a in range(len(leave)):
        for b in range(len(arrive)):
            if leave[a, 0] == arrive[b, 0]:
                turn = abs(leave[a, 1] - arrive[b, 1])
                way = leave[a, 2] + arcs.radius[int(leave[a, 0])] * turn + arrive[b, 2]
                if way < best:
                    best, first, last = way, a, b
    return best, first, last


@kernel
def _beside(arcs: Arcs, graph: Tangents, links: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the length (N,) from each node over the better adjacent link, and that link (N,).

    inf and -1 if no link is adjacent to the node on its arc.
    """
    length, link = np.full(len(graph.arc), math.inf), np.full(len(graph.arc), -1)
    for a in range(len(links)):
        k = int(links[a, 0])
        at = _after(graph, k, links[a, 1])
        for n in range(max(at - 1, graph.first[k]), min(at + 1, graph.first[k + 1])):
            way = links[a, 2] + arcs.radius[k] * abs(links[a, 1] - graph.angle[n])
            if way < length[n]:
                length[n], link[n] = way, a
    return length, link


@kernel
def _found(parent: IntArray, best: float, first: int, last: int, node: int) -> Found:
    count, n = 0, node
    while n >= 0:
        n = parent[n]
        count += 1
    if node >= 0:
        first = -2 - n
    nodes = np.empty(count, np.int64)
    n = node
    for k in range(count - 1, -1, -1):
        nodes[k] = n
        n = parent[n]
    return Found(best, first, last, nodes)


@kernel
def _lower_bound(graph: Tangents, n: int, x: float, y: float, tolerance: float) -> float:
    """Return a lower bound [m] of a path from node n to the goal."""
    dx, dy = graph.point[n, 0] - x, graph.point[n, 1] - y
    return max(0.0, math.sqrt(dx * dx + dy * dy) - tolerance)


@kernel
def _after(graph: Tangents, arc: int, angle: float) -> int:
    """Return the first node of an arc beyond an angle."""
    low, high = graph.first[arc], graph.first[arc + 1]
    while low < high:
        mid = (low + high) // 2
        if graph.angle[mid] < angle:
            low = mid + 1
        else:
            high = mid
    return int(low)
