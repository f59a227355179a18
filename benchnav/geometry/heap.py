"""A binary heap in two arrays: keys, and what they are the keys of."""

from benchnav.arrays import FloatArray, IntArray
from benchnav.kernels import kernel


@kernel
def push(key: FloatArray, item: IntArray, count: int, value: float, what: int) -> int:
    """Adds ``what`` under ``value`` to the ``count`` items; returns how many there are."""
    at = count
    while at > 0 and key[(at - 1) // 2] > value:
        key[at], item[at] = key[(at - 1) // 2], item[(at - 1) // 2]
        at = (at - 1) // 2
    key[at], item[at] = value, what
    return count + 1


@kernel
def pop(key: FloatArray, item: IntArray, count: int) -> int:
    """Removes the least key, which is the first; returns how many are left."""
    count -= 1
    value, what = key[count], item[count]
    at = 0
    while True:
        child = 2 * at + 1
        if child >= count:
            break
        if child + 1 < count and key[child + 1] < key[child]:
            child += 1
        if key[child] >= value:
            break
        key[at], item[at] = key[child], item[child]
        at = child
    key[at], item[at] = value, what
    return count
