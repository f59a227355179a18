"""Intervals of paired differences, on closed cases. Their coverage is in test_coverage.py."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from benchnav.leaderboard.difference import Pairs, correlation, difference
from benchnav.leaderboard.estimate import columns_of
from benchnav.leaderboard.interval import mid_p, resample
from tests.leaderboard.tables import METRICS

SIDES = st.lists(st.tuples(st.integers(0, 4), st.integers(0, 4)), min_size=2, max_size=30)


def found(one, other, name="success", agents=4.0):
    one, other = (np.asarray(side, float).reshape(len(one), -1) for side in (one, other))
    size = np.full_like(one, agents)
    pairs = Pairs(one, other, size, size, resample(len(one), np.random.default_rng(0)))
    return difference(pairs, columns_of([METRICS[name]] * one.shape[1]))


@settings(max_examples=50, deadline=None)
@given(SIDES)
def test_turned_round_it_is_the_same(sides):
    one, other = (np.array(side) / 4 for side in zip(*sides, strict=True))
    ahead, behind = found(one, other), found(other, one)
    assert ahead.value == pytest.approx(-behind.value)
    assert ahead.low == pytest.approx(-behind.high)
    assert -1 <= ahead.low <= ahead.value <= ahead.high <= 1


@settings(max_examples=50, deadline=None)
@given(SIDES)
def test_all_who_failed_instead_of_succeeding_turn_it_too(sides):
    one, other = (np.array(side) / 4 for side in zip(*sides, strict=True))
    assert found(1 - one, 1 - other).low == pytest.approx(found(other, one).low)


def test_of_single_agents_it_is_newcombes_with_mid_p():
    """36 pairs won by both, 12 by the first alone, 2 by the second, none by neither."""
    one = np.repeat([1.0, 1.0, 0.0], [36, 12, 2])
    other = np.repeat([1.0, 0.0, 1.0], [36, 12, 2])
    (l1, l2), (u1, u2) = mid_p(np.array([0.96, 0.76]), np.full(2, 50.0))
    phi = np.corrcoef(one, other)[0, 1]
    down = (0.96 - l1) ** 2 - 2 * phi * (0.96 - l1) * (u2 - 0.76) + (u2 - 0.76) ** 2
    up = (u1 - 0.96) ** 2 - 2 * phi * (u1 - 0.96) * (0.76 - l2) + (0.76 - l2) ** 2
    known = found(one, other, agents=1.0)
    assert known.value == pytest.approx([0.2])
    assert known.low == pytest.approx([0.2 - np.sqrt(down)])
    assert known.high == pytest.approx([0.2 + np.sqrt(up)])


def test_of_many_worlds_it_is_scipys_paired_t():
    rng = np.random.default_rng(1)
    ease = rng.beta(4, 2, 4000)
    one, other = (rng.binomial(4, np.clip(ease + d, 0, 1)) / 4 for d in (0.05, -0.05))
    known = stats.ttest_rel(one, other).confidence_interval(0.95)
    width = known.high - known.low
    for name in ("success", "spl"):
        ours = found(one, other, name)
        assert ours.low == pytest.approx([known.low], abs=0.03 * width)
        assert ours.high == pytest.approx([known.high], abs=0.03 * width)


def test_equal_values_keep_the_width_that_their_number_allows():
    ours = found([1.0] * 30, [1.0] * 30)
    assert (ours.value[0], ours.low[0] < -0.09, ours.high[0] > 0.09) == (0.0, True, True)
    ours = found([0.5] * 30, [0.5] * 30, "spl")
    assert ours.low == pytest.approx(-(1 - 0.025 ** (1 / 30)))
    assert np.isnan(found([0.5] * 30, [0.5] * 30, "turning").low)


def test_worlds_that_one_side_lacks_say_nothing():
    one = np.array([0.5, 1.0, 0.0, 0.75, np.nan, 1.0])
    other = np.array([0.0, 1.0, 0.25, 0.5, 1.0, np.nan])
    whole, part = found(one, other), found(one[:4], other[:4])
    assert (whole.value, whole.low, whole.high) == (part.value, part.low, part.high)


def test_the_correlation_is_numpys_or_nothing():
    rng = np.random.default_rng(2)
    one, other = rng.normal(size=(9, 2)), rng.normal(size=(9, 2))
    other[:, 1] = 0.5
    assert correlation(one, other) == pytest.approx([np.corrcoef(one[:, 0], other[:, 0])[0, 1], 0])
