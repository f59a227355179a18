"""What differs in length, put one after another with a field that counts."""

from collections.abc import Iterable, Iterator
from itertools import accumulate, pairwise

import numpy as np

from benchnav.arrays import AnyArray, IntArray


def counts(lengths: Iterable[int]) -> IntArray:
    """(N,) how much belongs to each."""
    return np.array(list(lengths), np.int64)


def parts(lengths: IntArray) -> Iterator[slice]:
    """Where each stands among all."""
    ends = accumulate((int(length) for length in lengths), initial=0)
    return (slice(first, stop) for first, stop in pairwise(ends))


def stacked(arrays: Iterable[AnyArray], width: int, kind: type = float) -> AnyArray:
    """(sum of N, width) of arrays (N, width), also of none."""
    return np.vstack([np.zeros((0, width), kind), *arrays])
