import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from benchnav.leaderboard.statistics import interval
from benchnav.leaderboard.statistics.interval import (
    RESAMPLES,
    bca,
    cumulants,
    effective_size,
    mean,
    mid_p,
    recover,
    resample,
    resampled_means,
    students,
    trimmed_mean,
    unanimous,
)


@pytest.mark.parametrize("size", [1, 5, 20, 100])
def test_mid_p_bounds_are_where_scipys_binomial_says(size):
    won = np.arange(size + 1)
    low, high = mid_p(won / size, np.full(size + 1, float(size)))
    assert (low[0], high[-1]) == (0.0, 1.0)

    def above(k, p):
        return stats.binom.sf(k, size, p) + 0.5 * stats.binom.pmf(k, size, p)

    assert above(won[1:], low[1:]) == pytest.approx(np.full(size, 0.025), abs=1e-9)
    assert above(won[:-1], high[:-1]) == pytest.approx(np.full(size, 0.975), abs=1e-9)
    exact = [stats.binomtest(int(k), size).proportion_ci(method="exact") for k in won]
    assert np.all(low >= np.array([ci.low for ci in exact]) - 1e-9)
    assert np.all(high <= np.array([ci.high for ci in exact]) + 1e-9)
    assert low == pytest.approx(1 - high[::-1], abs=1e-9)


@pytest.mark.parametrize("size", [50, 100, 200])
def test_mid_p_covers_exactly_what_is_asked(size):
    """One agent a world: no simulation, every outcome with its probability."""
    won = np.arange(size + 1)
    low, high = mid_p(won / size, np.full(size + 1, float(size)))

    def covered(p):
        return stats.binom.pmf(won, size, p)[(low <= p) & (p <= high)].sum()

    usual = [covered(p) for p in np.arange(0.05, 0.951, 0.05)]
    assert min(usual) >= 0.93
    assert max(usual) <= 0.97
    assert min(covered(p) for p in (0.01, 0.02, 0.98, 0.99)) >= 0.93


@given(st.integers(1, 200), st.floats(0, 1))
def test_unanimous_worlds_are_read_as_exactly_as_a_binomial(count, value):
    sure = stats.binomtest(count, count).proportion_ci(method="exact")
    low, high = unanimous(np.ones(1), np.array([float(count)]), np.zeros(1), np.ones(1))
    assert (low[0], high[0]) == (pytest.approx(sure.low), 1.0)
    low, high = unanimous(np.array([value]), np.array([float(count)]), np.zeros(1), np.ones(1))
    assert 0 <= low[0] <= value <= high[0] <= 1


@given(st.lists(st.sampled_from([0.0, 1.0]), min_size=2, max_size=30))
def test_one_agent_a_world_is_worth_one_trial(rates):
    values = np.array(rates)[:, None]
    assert effective_size(values, np.ones_like(values)) == pytest.approx([len(rates)])


def test_agents_that_share_their_fate_are_worth_their_worlds():
    together = np.array([0.0, 1.0, 1.0, 0.0, 1.0])[:, None]
    assert effective_size(together, np.full_like(together, 4.0)) == pytest.approx([5.0])


def test_agents_that_all_agree_everywhere_are_worth_their_worlds():
    assert effective_size(np.ones((6, 1)), np.full((6, 1), 4.0)) == pytest.approx([6.0])


def test_independent_agents_are_worth_themselves():
    rng = np.random.default_rng(0)
    rates = rng.binomial(4, 0.5, (20_000, 1)) / 4
    size = effective_size(rates, np.full_like(rates, 4.0))
    assert size == pytest.approx([80_000], rel=0.05)


@given(
    st.lists(st.tuples(st.integers(0, 4), st.integers(1, 4)), min_size=1, max_size=20),
)
def test_effective_size_lies_between_worlds_and_agents(worlds):
    agents = np.array([float(m) for _, m in worlds])[:, None]
    rates = np.array([min(k, m) / m for k, m in worlds])[:, None]
    size = effective_size(rates, agents)[0]
    assert len(worlds) - 1e-9 <= size <= agents.sum() + 1e-9


def test_effective_size_leaves_undefined_worlds_out():
    rates = np.array([0.0, 0.5, 1.0, 0.25, np.nan, np.nan])[:, None]
    agents = np.array([4.0, 4.0, 4.0, 4.0, 0.0, 4.0])[:, None]
    assert effective_size(rates, agents) == pytest.approx(effective_size(rates[:4], agents[:4]))


def test_the_bootstrap_is_scipys_where_the_expansion_vanishes():
    rng = np.random.default_rng(5)
    values = rng.exponential(size=(400, 1)) ** 1.5
    counts = np.vstack([resample(400, np.random.default_rng(k)) for k in range(10)])
    second, third = cumulants(values)
    low, high = bca(
        resampled_means(values, counts), mean(values), third / (6 * second**1.5),
        np.array([400.0]), np.array([399.0]),
    )  # fmt: skip
    known = stats.bootstrap(
        (values[:, 0],), np.mean, n_resamples=20_000, method="BCa", rng=np.random.default_rng(1)
    ).confidence_interval
    width = known.high - known.low
    assert low[0] == pytest.approx(known.low, abs=0.03 * width)
    assert high[0] == pytest.approx(known.high, abs=0.03 * width)


def test_the_acceleration_is_that_of_the_jackknife():
    values = np.random.default_rng(2).gamma(1.0, size=12)
    jackknife = np.array([np.delete(values, i).mean() for i in range(12)])
    gap = jackknife.mean() - jackknife
    by_hand = (gap**3).sum() / (6 * (gap**2).sum() ** 1.5)
    second, third = cumulants(values[:, None])
    assert third[0] / (6 * second[0] ** 1.5) == pytest.approx(by_hand)


def test_small_samples_get_students_width():
    values = np.random.default_rng(8).normal(size=(6, 400))
    counts = resample(6, np.random.default_rng(0))
    low, high = bca(
        resampled_means(values, counts), mean(values), np.zeros(400),
        np.full(400, 6.0), np.full(400, 5.0),
    )  # fmt: skip
    student = 2 * stats.t.ppf(0.975, 5) * values.std(axis=0, ddof=1) / np.sqrt(6)
    assert np.mean((high - low) / student) == pytest.approx(0.9, abs=0.1)


@settings(max_examples=30, deadline=None)
@given(st.integers(1, 40), st.integers(0, 2**32))
def test_resamples_are_made_of_the_values(count, seed):
    counts = resample(count, np.random.default_rng(seed))
    assert (counts.sum(axis=1) == count).all()


def test_resampled_means_leave_undefined_values_out():
    values = np.array([[1.0, 5.0], [np.nan, 5.0], [3.0, np.nan]])
    counts = np.array([[1, 1, 1], [0, 2, 1], [0, 3, 0]], np.uint8)
    assert resampled_means(values, counts) == pytest.approx(
        np.array([[2.0, 5.0], [3.0, 5.0], [2.0, 5.0]])  # nothing drawn: the mean, 2
    )


def test_recovered_interval_of_one_stratum_is_its_own():
    one = (np.array([0.4]), np.array([0.3]), np.array([0.6]))
    assert recover(*one, 0.0, 1.0) == pytest.approx((0.3, 0.6))


def test_recovered_interval_narrows_with_strata_and_stays_in_range():
    value, low, high = np.full(4, 1.0), np.full(4, 0.84), np.full(4, 1.0)
    assert recover(value, low, high, 0.0, 1.0) == pytest.approx((0.92, 1.0))


@given(st.lists(st.floats(-9, 9), min_size=2, max_size=9), st.integers(1, 50))
def test_quantiles_and_trimmed_means_are_scipys(values, freedom):
    found = students(np.array([freedom, 0, math.nan]))
    assert found[0] == pytest.approx(stats.t.ppf(0.975, freedom))
    assert np.isnan(found[1:]).all()
    column = np.array(values)[:, None]
    expected = pytest.approx(stats.trim_mean(column, 0.25, axis=0), abs=1e-12)
    assert trimmed_mean(column, 0.25) == expected


@pytest.mark.parametrize("count", [1, 2, 7, 255, 256, 1000])
def test_resamples_are_those_of_one_large_draw(count):
    drawn = np.random.default_rng(5).integers(count, size=(RESAMPLES, count))
    expected = [np.bincount(row, minlength=count) for row in drawn]
    assert np.array_equal(resample(count, np.random.default_rng(5)), expected)


def test_means_of_many_units_are_computed_in_blocks(monkeypatch):
    values = np.random.default_rng(1).normal(size=(300, 3))
    counts = resample(300, np.random.default_rng(2))
    whole = resampled_means(values, counts)
    assert np.array_equal(whole, (counts / 300.0) @ values)
    monkeypatch.setattr(interval, "_BLOCK", 7000)
    assert resampled_means(values, counts) == pytest.approx(whole, rel=1e-12)
