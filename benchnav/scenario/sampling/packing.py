"""Bounds on the number of agents in a region, and lattices of packed agents."""

import math

import numpy as np

from benchnav.arrays import BoolArray, Extent, FloatArray
from benchnav.scenario.sampling.region import Anywhere, DiscRegion, Points, Rectangle, Region, Ring

Box4 = Extent
ROW = math.sqrt(0.75)  # distance of rows of a hexagonal lattice, in spacings
MAX_POINTS = 2_000_000  # lattice points that are examined


def most_that_fit(region: Region, arena: Box4, least: float, margin: float) -> int:
    """Return an upper bound of the number of points in ``region`` at distances ≥ ``least`` > 0.

    Groemer 1960 and Oler 1961 (An inequality in the geometry of numbers): a compact
    convex set of area A and perimeter P holds at most 2/√3·A/d² + P/(2d) + 1 points of
    mutual distance d. For other sets, the convex hull is used.

    Args:
        region: of centres.
        arena: bounds [m].
        least: distance between any two [m].
        margin: distance of centres from the arena's bounds [m].
    """
    if isinstance(region, Points):
        return len(region.points)
    x0, y0, x1, y1 = region.box(arena)
    width = min(x1, arena[2] - margin) - max(x0, arena[0] + margin)
    depth = min(y1, arena[3] - margin) - max(y0, arena[1] + margin)
    if width < 0.0 or depth < 0.0:
        return 0
    bounds = [(width * depth, 2.0 * (width + depth))]
    if isinstance(region, DiscRegion | Ring):
        radius = region.radius if isinstance(region, DiscRegion) else region.outer
        bounds.append((math.pi * radius * radius, 2.0 * math.pi * radius))
    most = min(
        2.0 / math.sqrt(3.0) * area / (least * least) + around / (2.0 * least) + 1.0
        for area, around in bounds
    )
    return int(most + 1e-9)


def lattice(
    front: tuple[float, float], spacing: float, region: Region, arena: Extent, count: int
) -> FloatArray:
    """Return up to ``count`` points (N, 2) [m] of a hexagonal lattice in ``region``, nearest first.

    The lattice has a point at ``front``, and rows along x; of equally distant points,
    the lower and then the left one comes first.
    """
    reach = spacing * (2.0 + math.sqrt(count))
    while True:
        points, whole = _within(front, spacing, region, arena, reach)
        if whole or len(points) >= count:
            return points[:count]
        reach *= 2.0


def _within(
    front: tuple[float, float], spacing: float, region: Region, arena: Extent, reach: float
) -> tuple[FloatArray, bool]:
    """Return lattice points within ``reach``, nearest first, and whether these are all."""
    box = region.box(arena)
    low = [max(box[k] - front[k], -reach) / spacing for k in (0, 1)]
    high = [min(box[k + 2] - front[k], reach) / spacing for k in (0, 1)]
    rows = np.arange(math.ceil(low[1] / ROW - 1e-9), math.floor(high[1] / ROW + 1e-9) + 1)
    columns = np.arange(math.ceil(low[0] - 0.5), math.floor(high[0] + 0.5) + 1)
    corner = max(math.hypot(box[i] - front[0], box[j] - front[1]) for i in (0, 2) for j in (1, 3))
    whole = reach >= corner or 4 * len(rows) * len(columns) > MAX_POINTS
    j, i = (grid.ravel() for grid in np.meshgrid(rows, columns, indexing="ij"))
    offset = np.stack([i + 0.5 * (j % 2), ROW * j], axis=1)
    away = np.round(np.sum(offset * offset, axis=1), 6)
    points = np.array(front) + spacing * offset
    good = inside_region(region, arena, points) & (away * spacing**2 <= reach * reach)
    order = np.lexsort((offset[good, 0], offset[good, 1], away[good]))
    return points[good][order], whole


def inside_region(region: Region, arena: Box4, points: FloatArray) -> BoolArray:
    """Whether points (N, 2) are in the region, its edge included (to a nanometre), (N,)."""
    slack = 1e-9
    if isinstance(region, Rectangle | Anywhere):
        x0, y0, x1, y1 = region.box(arena)
        good: BoolArray = np.all((points >= [x0 - slack, y0 - slack]), axis=1)
        good &= np.all((points <= [x1 + slack, y1 + slack]), axis=1)
        return good
    if isinstance(region, Points):
        given: BoolArray = np.any(
            np.all(points[:, None] == np.array(region.points), axis=2), axis=1
        )
        return given
    inner, outer = (
        (region.inner, region.outer) if isinstance(region, Ring) else (0.0, region.radius)
    )
    away = np.sqrt(np.sum((points - np.array(region.center)) ** 2, axis=1))
    ring: BoolArray = (away >= inner - slack) & (away <= outer + slack)
    return ring
