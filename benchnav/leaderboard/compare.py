"""Is one navigator better than another? Sign flips of paired differences, Holm, ranks.

The unit is the (scenario, seed) pair that both attempted. Columns are comparisons.
"""

from functools import lru_cache

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.leaderboard.interval import ALPHA

EXACT = 13  # pairs up to which all sign patterns are tried
FLIPS = 9_999
FIRST_FLIPS = 999
HOPELESS = 0.1  # p after the first flips beyond which more of them cannot matter
TOGETHER = 256  # pairs beyond which some flip together
BLOCK = 512  # side of one product, which then stays in the cache


def sign_flip(differences: FloatArray, flips: int = FLIPS) -> FloatArray:
    """(C,) two-sided p-values of no difference, from paired differences (n, C).

    Under the hypothesis each difference is as likely to have the other sign. Pairs that
    are undefined (NaN) or equal drop out, for flipping them changes nothing. Up to 13
    pairs all patterns are counted, and where all k have one sign p is 2^(1 − k), for no
    other sum is as far from zero. Else it is from ``flips`` random ones and the observed one:
    (1 + count)/(1 + flips), B. Phipson and G. K. Smyth, "Permutation p-values should
    never be zero", Stat. Appl. Genet. Mol. Biol. 9 (2010). Where that many flips could
    not tell p from 0, it is Hoeffding's bound instead. Of more than 256 pairs every
    256th flip together, which is a test of the same hypothesis with fewer patterns.
    """
    value = _fold(np.nan_to_num(differences, nan=0.0))
    moved = (value != 0.0).sum(axis=0)
    p = np.ones(value.shape[1])
    for k in np.unique(moved[(moved > 0) & (moved <= EXACT)]):
        columns = np.flatnonzero(moved == k)
        part = value[:, columns]
        p[columns] = _exact(part.T[part.T != 0.0].reshape(len(columns), k).T)
    many = moved > EXACT
    one_way = many & ((value >= 0.0).all(axis=0) | (value <= 0.0).all(axis=0))
    p[one_way] = 2.0 ** (1 - moved[one_way])
    bound = _bound(value)
    clear = many & ~one_way & (bound < 1 / (1 + flips))
    p[clear] = bound[clear]
    open_ = np.flatnonzero(many & ~one_way & ~clear)
    if len(open_):
        p[open_] = _sampled(value[:, open_], flips)
    return p


def _bound(differences: FloatArray) -> FloatArray:
    """(C,) no p-value by sign flips is greater than 2·exp(−(Σd)²/(2·Σd²)).

    W. Hoeffding, "Probability inequalities for sums of bounded random variables", JASA 58
    (1963), theorem 2.
    """
    spread = np.maximum((differences**2).sum(axis=0), np.finfo(float).tiny)
    bound: FloatArray = 2.0 * np.exp(-(differences.sum(axis=0) ** 2) / (2.0 * spread))
    return bound


def _fold(differences: FloatArray) -> FloatArray:
    """(min(n, 256), C) sums of the pairs that flip together."""
    if len(differences) <= TOGETHER:
        return differences
    return np.array([differences[start::TOGETHER].sum(axis=0) for start in range(TOGETHER)])


def _exact(differences: FloatArray) -> FloatArray:
    """Share of the 2ᵏ sign patterns at least as extreme; by symmetry half are enough."""
    k = len(differences)
    flipped = np.arange(1 << (k - 1))[:, None] >> np.arange(k) & 1
    return _extreme(np.where(flipped, -1.0, 1.0), differences) / float(1 << (k - 1))


@lru_cache(maxsize=4)
def _patterns(pairs: int, flips: int) -> FloatArray:
    """(P, n) random signs that depend on nothing else."""
    flipped = np.random.default_rng(pairs).integers(0, 2, size=(flips, pairs), dtype=np.int8)
    return np.where(flipped, -1.0, 1.0)


def _sampled(differences: FloatArray, flips: int) -> FloatArray:
    """Random patterns: few for all comparisons, more where they might decide."""
    signs = _patterns(len(differences), flips)
    first = min(FIRST_FLIPS, flips)
    p = (1 + _extreme(signs[:first], differences)) / (1 + first)
    undecided = np.flatnonzero(p <= HOPELESS)
    if first < flips and len(undecided):
        p[undecided] = (1 + _extreme(signs, differences[:, undecided])) / (1 + flips)
    return p


def _extreme(signs: FloatArray, differences: FloatArray) -> FloatArray:
    """(C,) how many sign patterns (P, k) give a sum at least as far from zero as observed."""
    slack = 1e-12 * np.abs(differences).sum(axis=0)  # equal sums differ by rounding
    observed = np.abs(differences.sum(axis=0)) - slack
    count = np.zeros(differences.shape[1])
    for left in range(0, differences.shape[1], BLOCK):
        columns = slice(left, left + BLOCK)
        part = np.ascontiguousarray(differences[:, columns])
        for top in range(0, len(signs), BLOCK):
            sums = np.abs(signs[top : top + BLOCK] @ part)
            count[columns] += np.count_nonzero(sums >= observed[columns], axis=0)
    return count


def holm(p: FloatArray) -> FloatArray:
    """(C,) p-values adjusted for all of their family being tested at once.

    S. Holm, "A simple sequentially rejective multiple test procedure", Scandinavian
    Journal of Statistics 6 (1979).
    """
    order = np.argsort(p, kind="stable")
    scaled = p[order] * np.arange(len(p), 0, -1)
    adjusted = np.empty_like(p)
    adjusted[order] = np.minimum(np.maximum.accumulate(scaled), 1.0)
    return adjusted


def pairs(navigators: int) -> tuple[IntArray, IntArray]:
    """(C,), (C,) both sides of every comparison of N navigators."""
    first, second = np.triu_indices(navigators, 1)
    return first.astype(np.int64), second.astype(np.int64)


def ranks(lead: FloatArray, adjusted: FloatArray, navigators: int) -> tuple[IntArray, IntArray]:
    """(N,), (N,) rank intervals [1 + significantly better, N − significantly worse].

    ``lead`` (C,) is how much better the first of each of ``pairs`` is, and ``adjusted``
    (C,) the p-value after Holm.
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


def flips_for(family: int) -> int:
    """Enough flips for the smallest p-value to survive Holm over ``family`` tests, twice over."""
    return max(FLIPS, 2 * int(family / ALPHA))


def comparable(attempted: BoolArray) -> BoolArray:
    """(N,) navigators that attempted the same worlds, from (S, N).

    Where coverage differs, the set of worlds that most navigators share ranks; of two
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
