"""Paired differences over fixed scenarios: interval and p-value are one inference."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy import stats

from benchnav.leaderboard.statistics.difference import Moments, difference, least_p
from benchnav.leaderboard.statistics.estimate import columns_of
from tests.leaderboard.tables import METRICS
from tests.reference.paired_difference import inference

QUARTERS = st.integers(-4, 4).map(lambda k: k / 4)
SCENARIOS = st.lists(st.lists(QUARTERS, min_size=1, max_size=12), min_size=1, max_size=6)


def found(scenarios, metric="success"):
    """Of lists of differences, one list for each scenario."""
    parts = [Moments.of(np.array(worlds, float).reshape(-1, 1)) for worlds in scenarios]
    return difference(parts, columns_of([METRICS[metric]]))


def excluded(d):
    return bool(d.low[0] > 0.0 or d.high[0] < 0.0)


@settings(max_examples=300, deadline=None)
@given(SCENARIOS, st.sampled_from(["success", "spl", "turning"]))
def test_the_interval_excludes_zero_exactly_where_p_is_below_five_percent(scenarios, metric):
    d = found(scenarios, metric)
    assert excluded(d) == (d.p[0] < 0.05)
    if not math.isnan(d.low[0]):
        assert d.low[0] <= d.value[0] <= d.high[0]


@settings(max_examples=100, deadline=None)
@given(SCENARIOS, st.sampled_from([("success", 1.0), ("turning", math.inf)]))
def test_it_agrees_with_its_slow_twin(scenarios, kind):
    metric, width = kind
    assume(sum(map(len, scenarios)) > 1)
    d, twin = found(scenarios, metric), inference(scenarios, width)
    assert d.value[0] == pytest.approx(twin.value, abs=1e-12)
    if not twin.error:
        assert (d.p[0], math.isnan(d.low[0])) == (1.0, True)
        return
    assert d.p[0] == pytest.approx(twin.p(), rel=1e-6)
    low, high = twin.interval()
    assert d.low[0] == pytest.approx(max(low, -width), abs=1e-7)
    assert d.high[0] == pytest.approx(min(high, width), abs=1e-7)


@settings(max_examples=100, deadline=None)
@given(SCENARIOS, st.randoms(use_true_random=False))
def test_neither_order_nor_sign_changes_anything(scenarios, random):
    d = found(scenarios)
    turned = found([[-x for x in worlds] for worlds in scenarios])
    assert turned.p == pytest.approx(d.p)
    assert (turned.low[0], turned.high[0]) == pytest.approx((-d.high[0], -d.low[0]))
    mixed = [random.sample(worlds, len(worlds)) for worlds in scenarios]
    random.shuffle(mixed)
    again = found(mixed)
    assert (again.p[0], again.low[0]) == pytest.approx((d.p[0], d.low[0]))


@settings(max_examples=50, deadline=None)
@given(SCENARIOS, st.sampled_from([1e-9, 0.1, 1e9]))
def test_the_unit_of_an_unbounded_metric_changes_nothing(scenarios, unit):
    plain = found(scenarios, "turning")
    other = found([[unit * x for x in worlds] for worlds in scenarios], "turning")
    assert other.p == pytest.approx(plain.p, rel=1e-6)
    assert other.low / unit == pytest.approx(plain.low, abs=1e-9, nan_ok=True)


def test_of_continuous_values_in_one_scenario_it_is_scipys_paired_t():
    symmetric = stats.norm.ppf((np.arange(30) + 0.5) / 30) + 0.4
    d = found([symmetric], "turning")
    known = stats.ttest_1samp(symmetric, 0.0)
    assert d.p[0] == pytest.approx(known.pvalue, rel=1e-6)
    assert (d.low[0], d.high[0]) == pytest.approx(tuple(known.confidence_interval(0.95)))


def test_two_scenarios_are_welchs_test():
    """The mean of x and y is half the difference of x and −y."""
    x = stats.norm.ppf((np.arange(20) + 0.5) / 20) + 0.5
    y = 0.3 * stats.norm.ppf((np.arange(10) + 0.5) / 10) - 0.3
    d = found([x, y], "turning")
    known = stats.ttest_ind(x, -y, equal_var=False)
    assert d.value[0] == pytest.approx((x.mean() + y.mean()) / 2)
    # the degrees of freedom are Welch's own and not Satterthwaite's: a little more
    assert d.p[0] == pytest.approx(known.pvalue, rel=0.2)


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(["success", "spl", "turning"]), st.integers(1, 6), st.integers(3, 30),
    st.floats(1e-3, 1.0), st.floats(0.0, 0.1), st.integers(0, 99),
)  # fmt: skip
def test_better_by_a_constant_in_every_world_is_significant(
    metric, scenarios, worlds, constant, noise, seed
):
    """Of three worlds a scenario or more: two can leave a single degree of freedom."""
    assume(scenarios * worlds >= 10)
    noisy = 1.0 + noise * np.random.default_rng(seed).uniform(-1, 1, (scenarios, worlds))
    d = found(constant * noisy / noisy.max(), metric)
    assert d.p[0] < 0.01
    assert 0.0 < d.low[0] <= d.value[0] <= d.high[0]


def test_scenarios_that_differ_from_each_other_are_no_noise():
    """Better by 80 points in some scenarios and worse by 40 in others: 20 points in the mean."""
    rng = np.random.default_rng(2)
    levels = [0.8, -0.4, 0.8, -0.4, 0.2]
    d = found([level + rng.choice([-0.1, 0.0, 0.1], 20) for level in levels])
    assert d.p[0] < 1e-6
    assert 0.1 < d.low[0] < 0.2 < d.high[0] < 0.3
    pooled = stats.ttest_1samp(np.concatenate([[level] * 20 for level in levels]), 0.0)
    assert pooled.pvalue > 1e-4  # as if scenarios were a sample


def test_signs_that_cancel_are_no_difference():
    rng = np.random.default_rng(4)
    d = found([level + rng.choice([-0.25, 0.0, 0.25], 20) for level in (0.5, -0.5, 0.5, -0.5)])
    assert d.p[0] > 0.05


def test_equal_values_keep_the_width_that_their_number_allows():
    few, many = found([[0.0] * 20]), found([[0.0] * 20] * 5)
    assert (few.value[0], few.p[0]) == (0.0, 1.0)
    assert few.low[0] == pytest.approx(-stats.t.ppf(0.975, 19) * math.sqrt(2) / 20)
    assert few.low[0] == -few.high[0]
    assert few.high[0] / 6 < many.high[0] < few.high[0] / 4
    assert math.isnan(found([[0.0] * 20], "turning").low[0])
    assert found([[0.0] * 20], "turning").p[0] == 1.0


def test_one_world_says_nothing_and_two_say_little():
    one = found([[1.0]])
    assert (one.value[0], one.low[0], one.high[0], one.p[0]) == (1.0, -1.0, 1.0, 1.0)
    unbounded = found([[3.0]], "turning")
    assert (unbounded.p[0], math.isnan(unbounded.low[0])) == (1.0, True)
    assert found([[1.0, 1.0]]).p[0] > 0.05


def test_scenarios_of_one_world_each_are_a_sample_of_scenarios():
    values = stats.norm.ppf((np.arange(12) + 0.5) / 12) + 0.6
    apart, together = found(values.reshape(-1, 1), "turning"), found([values], "turning")
    assert apart.p[0] == pytest.approx(together.p[0], rel=0.2)
    assert apart.value[0] == pytest.approx(together.value[0])


def test_worlds_without_a_value_say_nothing():
    part = found([[0.5, 0.25, -0.25, 0.5], [0.0, 0.25]])
    whole = found([[0.5, math.nan, 0.25, -0.25, 0.5], [0.0, 0.25, math.nan], [math.nan] * 3])
    assert (whole.value[0], whole.low[0], whole.p[0]) == (part.value[0], part.low[0], part.p[0])
    assert whole.worlds[0] == 6
    nothing = found([[math.nan] * 3, [math.nan]])
    assert (nothing.worlds[0], nothing.p[0], math.isnan(nothing.value[0])) == (0, 1.0, True)


def test_rounding_is_no_spread():
    """0.1 + 0.2 − 0.3 and the like: noise in the last digit must not look like certainty."""
    noisy = 0.3 + np.array([0.0, 1.0, -1.0, 0.0]) * 5e-17
    assert found([noisy]).p[0] == pytest.approx(found([[0.3] * 4]).p[0], rel=1e-6)


def test_columns_do_not_feel_each_other():
    rng = np.random.default_rng(6)
    table = rng.integers(-4, 5, (15, 8)) / 4
    column = columns_of([METRICS["success"]] * 8)
    together = difference([Moments.of(table[:9]), Moments.of(table[9:])], column)
    for k in range(8):
        alone = found([table[:9, k], table[9:, k]])
        assert (alone.p[0], alone.low[0]) == pytest.approx((together.p[k], together.low[k]))


def test_the_least_p_is_that_of_worlds_that_all_differ_by_the_whole_range():
    for worlds in (2, 3, 5, 20):
        assert least_p(worlds) == pytest.approx(found([[1.0] * worlds]).p[0])
    assert least_p(1) == 1.0
    assert least_p(4) > 0.05 > least_p(5)
