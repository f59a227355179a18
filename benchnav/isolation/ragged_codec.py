"""Arrays of different lengths, concatenated, with a field that holds their lengths."""

from collections.abc import Iterable, Iterator
from itertools import accumulate, pairwise

import numpy as np

from benchnav.arrays import AnyArray, IntArray


def counts(lengths: Iterable[int]) -> IntArray:
    """Return the lengths as an array (N,)."""
    return np.array(list(lengths), np.int64)


def slices(lengths: IntArray) -> Iterator[slice]:
    """Yield the slice of each part in the concatenated array."""
    ends = accumulate((int(length) for length in lengths), initial=0)
    return (slice(first, stop) for first, stop in pairwise(ends))


def stack(arrays: Iterable[AnyArray], width: int, kind: type = float) -> AnyArray:
    """Return the arrays (N, width), possibly none, stack to (sum of N, width)."""
    return np.vstack([np.zeros((0, width), kind), *arrays])
