"""A binary heap in two arrays: keys and items."""

from benchnav.arrays import FloatArray, IntArray
from benchnav.kernels import kernel


@kernel
def push(key: FloatArray, item: IntArray, count: int, value: float, new: int) -> int:
    """Add ``new`` with key ``value`` to the ``count`` items; return the new count."""
    at = count
    while at > 0 and key[(at - 1) // 2] > value:
        key[at], item[at] = key[(at - 1) // 2], item[(at - 1) // 2]
        at = (at - 1) // 2
    key[at], item[at] = value, new
    return count + 1


@kernel
def pop(key: FloatArray, item: IntArray, count: int) -> int:
    """Remove the smallest key, which is the first; return the new count."""
    count -= 1
    value, new = key[count], item[count]
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
    key[at], item[at] = value, new
    return count
