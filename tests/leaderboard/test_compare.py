import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from benchnav.leaderboard.compare import (
    _bound,
    comparable,
    flips_for,
    holm,
    pairs,
    ranks,
    sign_flip,
)

DIFFERENCES = st.lists(st.integers(-8, 8).map(lambda k: k / 4), min_size=2, max_size=10)


def scipys(differences, **options):
    found = stats.permutation_test(
        (np.asarray(differences),), np.sum, permutation_type="samples",
        alternative="two-sided", **options,
    )  # fmt: skip
    return found.pvalue


@given(DIFFERENCES)
def test_few_pairs_are_exact(differences):
    found = sign_flip(np.array(differences)[:, None])
    assert found == pytest.approx([scipys(differences, n_resamples=np.inf)])


def test_few_pairs_with_real_values_are_exact():
    rng = np.random.default_rng(3)
    table = rng.normal(0.3, 1.0, (9, 20))
    known = [scipys(column, n_resamples=np.inf) for column in table.T]
    assert sign_flip(table) == pytest.approx(known)


def test_many_pairs_agree_with_scipy():
    rng = np.random.default_rng(4)
    table = rng.normal(0.35, 1.0, (30, 12))
    found = sign_flip(table)
    known = [scipys(column, n_resamples=19_999, rng=np.random.default_rng(0)) for column in table.T]
    # flips of the first stage alone tell a p above 0.1 to about ± 0.05
    loose = np.where(np.array(known) > 0.08, 0.06, 0.008)
    assert np.all(np.abs(found - known) < loose)


@given(DIFFERENCES)
def test_hoeffdings_bound_is_never_below_the_exact_p(differences):
    column = np.array(differences)[:, None]
    assert _bound(column)[0] >= sign_flip(column)[0] - 1e-12


def test_a_clear_difference_is_told_from_zero_in_time():
    p = sign_flip(np.append(np.full(99, 0.25), -0.01)[:, None])
    assert 0 < p[0] < 1e-20


@given(DIFFERENCES, st.integers(0, 2**32))
def test_p_depends_on_neither_order_nor_sign_nor_scale(differences, seed):
    column = np.array(differences)
    mixed = np.random.default_rng(seed).permutation(column)
    both = sign_flip(np.stack([column, mixed, -column, column * 8], axis=1))
    assert np.all(both == both[0])


def test_undefined_and_equal_pairs_drop_out():
    column = np.array([1.0, np.nan, 2.0, 0.0, 1.5, np.nan, 0.5])[:, None]
    assert sign_flip(column) == pytest.approx([2 / 2**4])
    assert sign_flip(np.full((30, 1), np.nan)) == pytest.approx([1.0])


def test_a_column_does_not_feel_its_neighbours():
    table = np.random.default_rng(6).normal(0.4, 1.0, (40, 8))
    assert np.array_equal(sign_flip(table)[[3]], sign_flip(table[:, [3]]))


@given(st.lists(st.sampled_from([-1.0, 0.0, 1.0]), min_size=1, max_size=13))
def test_pairs_that_are_won_or_lost_are_mcnemars(outcomes):
    """One agent a world: the exact test of discordant pairs."""
    won, lost = outcomes.count(1.0), outcomes.count(-1.0)
    known = stats.binomtest(won, won + lost).pvalue if won + lost else 1.0
    assert sign_flip(np.array(outcomes)[:, None]) == pytest.approx([known])


@given(st.lists(st.floats(0.1, 9), min_size=2, max_size=40))
def test_all_in_one_direction_is_exact_however_many(differences):
    column = np.array(differences)[:, None]
    assert sign_flip(-column) == pytest.approx([2.0 ** (1 - len(differences))])


def test_thousands_of_pairs_flip_together():
    rng = np.random.default_rng(7)
    quiet = rng.normal(0.0, 1.0, (3000, 40))
    p = sign_flip(quiet)
    assert 0.2 < np.mean(p) < 0.8
    assert sign_flip(quiet + 0.5).max() < 1e-4


def test_false_alarms_are_as_rare_as_they_say():
    p = sign_flip(np.random.default_rng(9).standard_t(3, (25, 3000)))
    assert np.mean(p < 0.05) == pytest.approx(0.05, abs=0.015)


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


def test_enough_flips_for_holm():
    for count in (2, 5, 20, 40):
        family = len(pairs(count)[0])
        assert family / (1 + flips_for(family)) < 0.05


def test_most_shared_worlds_rank():
    attempted = np.ones((6, 4), dtype=bool)
    attempted[4:, 3] = False
    assert comparable(attempted).tolist() == [True, True, True, False]
    attempted[4:, 2] = False  # two and two: more worlds win
    assert comparable(attempted).tolist() == [True, True, False, False]
    assert not comparable(np.zeros((3, 2), dtype=bool)).any()
