"""Edges of solids sorted into horizontal rows: whether a point is inside a solid, without a walk
over all edges.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.geometry.sweep import Outlined, solid_index, winding
from benchnav.kernels import kernel_without_allocation


class SolidRows(NamedTuple):
    """Solids, and the edges that rise or fall within each row, in the order of their solids."""

    edges: FloatArray  # (E, 4) x0, y0, x1, y1 [m], those of a row next to each other
    owner: IntArray  # (E,) solid of each edge
    start: IntArray  # (rows + 1,) first edge of each row
    low: float  # [m] where the first row begins
    height: float  # [m] of a row
    outside: IntArray  # (S,) winding number of each solid far away
    endless: int  # number of solids that extend to infinity


def solid_rows(solids: Sequence[Outlined]) -> SolidRows:
    """Return the rows of solids."""
    first, outside = solid_index(solids)
    owner = np.repeat(np.arange(len(solids)), np.diff(first))
    edges = np.vstack([np.zeros((0, 5)), *(solid.capsules for solid in solids)])[:, :4]
    slanting = edges[:, 1] != edges[:, 3]
    edges, owner = edges[slanting], owner[slanting]
    endless = int(np.count_nonzero(outside > 0))
    if not len(edges):
        start = np.zeros(2, np.int64)
        return SolidRows(edges, owner, start, 0.0, 1.0, outside, endless)
    bottom, top = np.minimum(edges[:, 1], edges[:, 3]), np.maximum(edges[:, 1], edges[:, 3])
    low, high = float(bottom.min()), float(top.max())
    # so high that an edge reaches two rows on average
    height = max((high - low) / len(edges), float((top - bottom).mean()))
    rows = int((high - low) / height) + 1
    from_, to = ((bottom - low) / height).astype(np.int64), ((top - low) / height).astype(np.int64)
    count = to - from_ + 1
    edge = np.repeat(np.arange(len(edges)), count)
    row = np.arange(len(edge)) - np.repeat(np.cumsum(count) - count - from_, count)
    order = np.argsort(row, kind="stable")
    edge, row = edge[order], row[order]
    start = np.searchsorted(row, np.arange(rows + 1))
    return SolidRows(
        np.ascontiguousarray(edges[edge]), owner[edge], start, low, height, outside, endless
    )


@kernel_without_allocation
def inside_rows(rows: SolidRows, px: float, py: float) -> bool:
    """Whether a point lies within the loops of any solid, like `benchnav.geometry.inside_solid`."""
    endless = rows.endless
    at = (py - rows.low) / rows.height
    if at >= 0.0 and at < len(rows.start) - 1:
        k, end = rows.start[int(at)], rows.start[int(at) + 1]
        while k < end:
            solid = rows.owner[k]
            turns = rows.outside[solid]
            if turns > 0:
                endless -= 1
            while k < end and rows.owner[k] == solid:
                edge = rows.edges[k]
                turns += winding(px, py, edge[0], edge[1], edge[2], edge[3])
                k += 1
            if turns > 0:
                return True
    return bool(endless > 0)  # a solid without edges in this row is on both sides, or on none
