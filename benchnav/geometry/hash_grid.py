"""Points in hashed cells: neighbours of a point without a dense grid over the plane.

A table of H = 2^k buckets is filled by counting sort; a cell's bucket may hold
other cells' points too, so every point keeps its own cell (ci, cj). Points are
records with x, y, present, ci, cj.
"""

import math

import numpy as np

from benchnav.arrays import AnyArray, IntArray
from benchnav.kernels import kernel


def hash_tables(batch: int, points: int) -> tuple[IntArray, IntArray]:
    """(hashed (batch, H+1), sorted (batch, A)) buffers for grids of up to A ``points``."""
    size = 1 << max(4, math.ceil(math.log2(2 * max(points, 1))))
    return np.zeros((batch, size + 1), np.int64), np.zeros((batch, max(points, 1)), np.int64)


@kernel
def bucket(i: int, j: int, size: int) -> int:
    """Bucket of cell (i, j) in a table of ``size`` (a power of two)."""
    return ((i * 73856093) ^ (j * 19349663)) & (size - 1)


@kernel
def fill(points: AnyArray, hashed: IntArray, sorted_: IntArray, side: float) -> None:
    """Sort the present points (A,) into cells of ``side`` [m].

    Bucket k then lists sorted_[hashed[k] : hashed[k + 1]], rising.
    """
    size = len(hashed) - 1
    hashed[:] = 0
    for i in range(len(points)):
        p = points[i]
        if p.present:
            p.ci, p.cj = math.floor(p.x / side), math.floor(p.y / side)
            hashed[bucket(p.ci, p.cj, size) + 1] += 1
    for k in range(size):
        hashed[k + 1] += hashed[k]
    total = hashed[size]
    # backwards, so that points rise within a bucket
    for i in range(len(points) - 1, -1, -1):
        p = points[i]
        if p.present:
            k = bucket(p.ci, p.cj, size)
            hashed[k + 1] -= 1
            sorted_[hashed[k + 1]] = i
    for k in range(size):
        hashed[k] = hashed[k + 1]
    hashed[size] = total
