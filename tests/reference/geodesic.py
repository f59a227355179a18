"""Slow, obvious twins of the geodesic kernels: loops, shapely, heapq."""

import heapq
import itertools
import math

import numpy as np
import shapely


def is_clear(capsules, radius, a, b, slack=1e-8):
    """Every capsule is at least both radii from the segment ab."""
    return all(
        shapely.LineString([c[:2], c[2:4]]).distance(shapely.LineString([a, b]))
        >= c[4] + radius - slack
        for c in capsules
    )


def point_is_clear(capsules, radius, p, slack=1e-8):
    return is_clear(capsules, radius, p, p, slack)


def is_on(arc, angle, slack=1e-9):
    """An arc is (x, y, radius, low, width)."""
    turn = (angle - arc[3]) % (2 * math.pi)
    return turn <= arc[4] + slack or turn >= 2 * math.pi - slack


def place(arc, angle):
    return arc[0] + arc[2] * math.cos(angle), arc[1] + arc[2] * math.sin(angle)


def bitangents(capsules, radius, arcs):
    """Set-like list of (i, angle, j, angle, length), i > j, angles absolute."""
    found = []
    for i, a in enumerate(arcs):
        for j, b in enumerate(arcs[:i]):
            dx, dy = b[0] - a[0], b[1] - a[1]
            d = math.hypot(dx, dy)
            if d < 1e-12:
                continue
            facing = math.atan2(dy, dx)
            for inner in (True, False):
                k = (a[2] + b[2] if inner else a[2] - b[2]) / d
                if abs(k) > 1:
                    continue
                for turn in (math.acos(k), -math.acos(k)):
                    u = facing + turn
                    v = u + math.pi if inner else u
                    if is_on(a, u) and is_on(b, v):
                        p, q = place(a, u), place(b, v)
                        if is_clear(capsules, radius, p, q):
                            found.append((i, u, j, v, math.dist(p, q)))
    return found


def length(capsules, radius, arcs, start, goal):
    """Dijkstra's algorithm over tangents and arcs; start and goal are arcs of radius 0."""
    if is_clear(capsules, radius, start, goal):
        return math.dist(start, goal)
    ends = [(*start, 0.0, 0.0, 2 * math.pi), (*goal, 0.0, 0.0, 2 * math.pi)]
    arcs = [*ends, *arcs]
    rim = [[] for _ in arcs]  # (angle from the arc's beginning, node)
    edges = {}
    for node, (i, u, j, v, far) in enumerate(bitangents(capsules, radius, arcs)):
        one, two = (node, 0), (node, 1)
        edges[one], edges[two] = [(two, far)], [(one, far)]
        for arc, angle, name in ((i, u, one), (j, v, two)):
            turn = (angle - arcs[arc][3]) % (2 * math.pi)
            rim[arc].append((0.0 if turn > arcs[arc][4] + 1e-6 else turn, name))
    for arc, nodes in zip(arcs, rim, strict=True):
        nodes.sort()
        pairs = list(itertools.pairwise(nodes))
        if arc[4] >= 2 * math.pi and len(nodes) > 1:
            pairs.append(((nodes[-1][0] - 2 * math.pi, nodes[-1][1]), nodes[0]))
        for (a, one), (b, two) in pairs:
            edges[one].append((two, arc[2] * (b - a)))
            edges[two].append((one, arc[2] * (b - a)))
    if not rim[0] or not rim[1]:
        return math.nan
    best = {rim[0][0][1]: 0.0}
    heap = [(0.0, rim[0][0][1])]
    while heap:
        far, node = heapq.heappop(heap)
        if node == rim[1][0][1]:
            return far
        for other, step in edges[node] if far <= best[node] else ():
            if far + step < best.get(other, math.inf):
                best[other] = far + step
                heapq.heappush(heap, (far + step, other))
    return math.nan


def polygonal_length(capsules, radius, start, ends, corners=6, outside=False):
    """A visibility graph of polygons instead of round corners, to the nearest of ``ends`` (E, 2).

    Polygons inside of the round ones give a lower bound of the length, polygons
    outside of them an upper bound.
    """
    grow = 1.0 / math.cos(math.pi / (4 * corners)) if outside else 1.0
    grown = [
        shapely.LineString([c[:2], c[2:4]]).buffer((c[4] + radius) * grow, quad_segs=corners)
        if tuple(c[:2]) != tuple(c[2:4])
        else shapely.Point(c[:2]).buffer((c[4] + radius) * grow, quad_segs=corners)
        for c in capsules
    ]
    solid = shapely.union_all(grown)
    nodes = np.vstack([[start], ends, shapely.get_coordinates(solid)])
    i, j = np.triu_indices(len(nodes), 1)
    lines = shapely.linestrings(np.stack([nodes[i], nodes[j]], axis=1))
    inner = solid.buffer(-1e-7)
    shapely.prepare(inner)
    sees = ~shapely.intersects(inner, lines)
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import dijkstra

    far = np.maximum(np.hypot(*(nodes[i] - nodes[j]).T), 1e-12)[sees]
    graph = coo_array((far, (i[sees], j[sees])), shape=(len(nodes), len(nodes)))
    return dijkstra(graph, directed=False, indices=0)[1 : 1 + len(ends)].min()
