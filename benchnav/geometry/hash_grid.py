"""Points in hashed cells: find the neighbours of a point without a dense grid over the plane.

A table of H = 2^k buckets is filled by counting sort; a bucket may hold points of several
cells, so every spot stores its own cell (ci, cj). Points are records with x, y, vx, vy, radius,
team, present, ci, cj; spots are copies of the fields that a search needs, in bucket order.
"""

import math
from typing import Any

import numpy as np

from benchnav.arrays import AnyArray, IntArray
from benchnav.kernels import kernel_without_allocation


def hash_table(batch: int, points: int) -> IntArray:
    """Return empty bucket bounds (batch, H+1) for grids of up to ``points`` points each."""
    size = 1 << max(4, math.ceil(math.log2(2 * max(points, 1))))
    return np.zeros((batch, size + 1), np.int64)


@kernel_without_allocation
def bucket(i: int, j: int, size: int) -> int:
    """Return the bucket of cell (i, j) in a table of ``size`` (a power of two).

    Cells that follow each other in a row have buckets that follow each other. Rows begin a golden
    section of the table apart, so that near rows share few buckets.
    """
    return (i + j * ((size * 40503 >> 16) | 1)) & (size - 1)


@kernel_without_allocation
def fill(points: AnyArray, hashed: IntArray, spots: AnyArray, side: float) -> None:
    """Sort the present points (A,) into cells of ``side`` [m].

    Bucket k then holds spots[hashed[k] : hashed[k + 1]], by ascending index.
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
    # backwards, so that indices rise within a bucket
    for i in range(len(points) - 1, -1, -1):
        p = points[i]
        if p.present:
            k = bucket(p.ci, p.cj, size)
            hashed[k + 1] -= 1
            _copy(p, i, spots[hashed[k + 1]])
    for k in range(size):
        hashed[k] = hashed[k + 1]
    hashed[size] = total


@kernel_without_allocation
def follow(points: AnyArray, hashed: IntArray, spots: AnyArray) -> bool:
    """Copy the velocities of the points (A,) to their spots.

    Return False if the points have changed in another way since the spots were sorted.
    """
    same = True
    for at in range(hashed[-1]):
        spot = spots[at]
        p = points[spot.index]
        same &= p.present & (p.x == spot.x) & (p.y == spot.y) & (p.radius == spot.radius)
        spot.vx, spot.vy = p.vx, p.vy
    count = 0
    for i in range(len(points)):
        count += points[i].present
    return bool(same & (count == hashed[-1]))


@kernel_without_allocation
def collect(points: AnyArray, hashed: IntArray, spots: AnyArray) -> None:
    """List the present points (A,) by index, without cells: they are spots[: hashed[-1]]."""
    n = 0
    for i in range(len(points)):
        if points[i].present:
            _copy(points[i], i, spots[n])
            n += 1
    hashed[-1] = n


@kernel_without_allocation
def _copy(point: Any, index: int, spot: Any) -> None:
    spot.x, spot.y, spot.vx, spot.vy = point.x, point.y, point.vx, point.vy
    spot.radius, spot.ci, spot.cj = point.radius, point.ci, point.cj
    spot.index, spot.team = index, point.team
