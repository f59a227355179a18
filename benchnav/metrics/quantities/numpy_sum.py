"""Sums in the order of numpy, so that a kernel returns the same bits as `numpy.sum`.

numpy adds a contiguous axis pairwise: blocks of up to 128 numbers in eight partial sums, and
longer arrays as the sum of their halves.
"""

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.kernels import kernel, kernel_without_allocation

_BLOCK = 128
_DEPTH = 64  # halvings of the longest array


@kernel
def numpy_sum(values: FloatArray) -> float:
    """Return the same bits as ``values.sum()`` for contiguous values (N,)."""
    if len(values) <= _BLOCK:
        return block_sum(values, 0, len(values))
    first, size, depth = np.empty((3, _DEPTH), np.int64)
    sums, level = np.empty(_DEPTH), np.empty(_DEPTH, np.int64)
    first[0], size[0], depth[0] = 0, len(values), 0
    waiting, ready = 1, 0
    while waiting > 0:
        waiting -= 1
        low, n, below = first[waiting], size[waiting], depth[waiting]
        if n > _BLOCK:  # its left half is the next one
            half = n // 2
            half -= half % 8
            first[waiting], size[waiting], depth[waiting] = low + half, n - half, below + 1
            first[waiting + 1], size[waiting + 1], depth[waiting + 1] = low, half, below + 1
            waiting += 2
            continue
        total = block_sum(values, low, n)
        while ready > 0 and level[ready - 1] == below:  # both halves are there
            ready -= 1
            total = sums[ready] + total
            below -= 1
        sums[ready], level[ready] = total, below
        ready += 1
    return float(sums[0])


@kernel_without_allocation
def block_sum(values: FloatArray, low: int, n: int) -> float:
    """Return the sum of ``values[low : low + n]``, at most 128 numbers."""
    total = 0.0
    if n < 8:
        for k in range(low, low + n):
            total += values[k]
        return total
    a, b, c, d = values[low], values[low + 1], values[low + 2], values[low + 3]
    e, f, g, h = values[low + 4], values[low + 5], values[low + 6], values[low + 7]
    end = low + n - n % 8
    for k in range(low + 8, end, 8):
        a, b, c, d = a + values[k], b + values[k + 1], c + values[k + 2], d + values[k + 3]
        e, f, g, h = e + values[k + 4], f + values[k + 5], g + values[k + 6], h + values[k + 7]
    total = float(((a + b) + (c + d)) + ((e + f) + (g + h)))
    for k in range(end, low + n):
        total += values[k]
    return total
