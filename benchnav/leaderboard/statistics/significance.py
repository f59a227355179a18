"""Significance of the comparisons of a family, and the ranks that follow.

Columns are comparisons.
"""

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.leaderboard.statistics.interval import ALPHA


def holm(p: FloatArray) -> FloatArray:
    """Return p-values (C,) adjusted for testing the whole family at once.

    S. Holm, "A simple sequentially rejective multiple test procedure", Scandinavian
    Journal of Statistics 6 (1979).
    """
    order = np.argsort(p, kind="stable")
    scaled = p[order] * np.arange(len(p), 0, -1)
    adjusted = np.empty_like(p)
    adjusted[order] = np.minimum(np.maximum.accumulate(scaled), 1.0)
    return adjusted


def pairs(navigators: int) -> tuple[IntArray, IntArray]:
    """Return both sides (C,), (C,) of every comparison of N navigators."""
    first, second = np.triu_indices(navigators, 1)
    return first.astype(np.int64), second.astype(np.int64)


def ranks(lead: FloatArray, adjusted: FloatArray, navigators: int) -> tuple[IntArray, IntArray]:
    """Return rank intervals (N,), (N,): [1 + significantly better, N − significantly worse].

    ``lead`` (C,) is the advantage of the first of each of ``pairs``, and ``adjusted``
    (C,) the p-value after Holm's correction.
    """
    first, second = pairs(navigators)
    decided = adjusted < ALPHA
    low = np.ones(navigators, dtype=np.int64)
    high = np.full(navigators, navigators, dtype=np.int64)
    for winner, loser, won in (
        (first, second, decided & (lead > 0)),
        (second, first, decided & (lead < 0)),
    ):
        np.add.at(low, loser[won], 1)
        np.subtract.at(high, winner[won], 1)
    return low, high


def comparable(attempted: BoolArray) -> BoolArray:
    """Return which navigators (N,) attempted the same worlds, from (S, N).

    If coverage differs, the set of worlds that most navigators share is ranked; of two
    such sets, the larger.
    """
    groups: dict[bytes, list[int]] = {}
    for navigator in range(attempted.shape[1]):
        if attempted[:, navigator].any():
            groups.setdefault(attempted[:, navigator].tobytes(), []).append(navigator)
    chosen = np.zeros(attempted.shape[1], dtype=np.bool_)
    if groups:

        def weight(key: bytes) -> tuple[int, int, bytes]:
            return len(groups[key]), int(attempted[:, groups[key][0]].sum()), key

        chosen[groups[max(groups, key=weight)]] = True
    return chosen
