import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchnav.leaderboard.statistics.significance import comparable, holm, pairs, ranks


def test_holm_by_hand():
    # 4·0.01, 3·0.02, 2·0.03, 1·0.04, none below the one before
    p = np.array([0.04, 0.01, 0.03, 0.02])
    assert holm(p) == pytest.approx([0.06, 0.04, 0.06, 0.06])
    assert holm(np.array([0.9, 0.8])) == pytest.approx([1.0, 1.0])
    assert holm(np.zeros(0)).shape == (0,)


@given(st.lists(st.floats(0, 1), min_size=1, max_size=12))
def test_holm_by_its_definition(p):
    rejected = holm(np.array(p)) < 0.05
    slow = [False] * len(p)
    for step, i in enumerate(sorted(range(len(p)), key=lambda i: p[i])):
        if not p[i] * (len(p) - step) < 0.05:
            break
        slow[i] = True
    assert list(rejected) == slow


def test_ranks_by_hand():
    # 0 beats 2; nothing else is told apart
    first, second = pairs(3)
    adjusted = np.where((first == 0) & (second == 2), 0.01, 0.5)
    low, high = ranks(np.array([0.1, 0.4, 0.1]), adjusted, 3)
    assert low.tolist() == [1, 1, 2]
    assert high.tolist() == [2, 3, 3]


@given(st.integers(2, 8), st.integers(0, 2**32))
def test_rank_intervals_hold_together(count, seed):
    rng = np.random.default_rng(seed)
    size = len(pairs(count)[0])
    low, high = ranks(rng.normal(size=size), rng.random(size) / 10, count)
    assert np.all((low >= 1) & (low <= high) & (high <= count))
    assert (low - 1).sum() == (count - high).sum()  # who wins, another loses


def test_most_shared_worlds_rank():
    attempted = np.ones((6, 4), dtype=bool)
    attempted[4:, 3] = False
    assert comparable(attempted).tolist() == [True, True, True, False]
    attempted[4:, 2] = False  # two and two: more worlds win
    assert comparable(attempted).tolist() == [True, True, False, False]
    assert not comparable(np.zeros((3, 2), dtype=bool)).any()
