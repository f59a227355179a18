"""Numbers show what their interval resolves: no more, and nothing that looks like another."""

import math

import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from benchnav.leaderboard.rendering.digits import (
    LARGEST,
    NARROWEST,
    aligned,
    figure,
    figures,
    number,
    signed,
)

RATES = st.floats(0.0, 1.0)
NUMBERS = st.floats(-1e9, 1e9)


def intervals(numbers):
    """Of three numbers, the value between its bounds, some of them alike."""
    return st.tuples(numbers, numbers, numbers).map(sorted).map(lambda x: (x[1], x[0], x[2]))


def same(a, b, scale=1.0):
    """Whether they differ by rounding only; large numbers share an exponent, which scales it."""
    return math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-12 * (scale if scale >= LARGEST else 1.0))


def resolved(value, low, high):
    """Intervals that are wide enough to choose the digits by."""
    assume(high - low > 2 * max(NARROWEST * max(map(abs, (value, low, high))), 1e-12))


def read(text):
    """The least and the greatest number that a text allows."""
    x = float(text.lstrip("<>"))
    return (-math.inf, x) if text[0] == "<" else (x, math.inf) if text[0] == ">" else (x, x)


def decimals(text):
    return len(text.lstrip("<>").partition(".")[2])


@pytest.mark.parametrize(
    ("numbers", "text"),
    [
        ((0.9995, 0.9981, 1.0), "0.9995 [0.9981, 1]"),
        ((0.994, 0.990, 0.9971), "0.994 [0.990, 0.997]"),
        ((1.0, 0.9963, 1.0), "1 [0.9963, 1]"),
        ((0.0, 0.0, 0.0027), "0 [0, 0.0027]"),
        ((0.0, 0.0, 0.139), "0 [0, 0.14]"),
        ((0.80, 0.738, 0.852), "0.80 [0.74, 0.85]"),
        ((0.95, 0.784, 0.9975), "0.950 [0.784, 0.998]"),
        ((0.03, 0.00055, 0.1714), "0.030 [0.001, 0.171]"),
        ((0.03, 0.00002, 0.1714), "0.030 [<0.001, 0.171]"),
        ((0.97, 0.81, 0.99999), "0.970 [0.810, >0.999]"),
        ((0.99999, 0.5, 1.0), "0.999 [0.500, 1]"),
        ((12.345, 11.2, 13.9), "12.3 [11.2, 13.9]"),
        ((1234.0, 984.0, 1484.0), "1234 [984, 1484]"),
        ((2.5e-7, 2.4e-7, 2.6e-7), "2.50e-07 [2.40e-07, 2.60e-07]"),
        ((0.00001, -0.3, 0.3), "0.00 [-0.30, 0.30]"),
        ((0.12, -0.001, 0.25), "0.120 [-0.001, 0.250]"),
        ((0.12, -0.00001, 0.25), "0.120 [>-0.001, 0.250]"),
        ((-1.0, -1.0, -0.9), "-1 [-1, -0.90]"),
        ((0.5, 0.5, 0.5), "0.50 [0.50, 0.50]"),
    ],
)
def test_decimals_follow_the_width(numbers, text):
    value, low, high = figures(*numbers, 1.0)
    assert f"{value} [{low}, {high}]" == text


def test_a_value_alone_has_at_most_four_figures():
    assert figure(0.998743, 0.998741, 0.998745, 1.0) == "0.9987"
    assert figure(9.83861, 9.83859, 9.83863) == "9.839"
    assert figure(0.999987, 0.999985, 0.999989, 1.0) == "0.99999"
    assert figure(1234.567, 1234.563, 1234.571) == "1235"


@given(intervals(RATES) | intervals(NUMBERS) | intervals(st.floats(-1e-6, 1e-6)))
@example((0.995, 0.9949, 0.99501))
@example((1e-5, 0.0, 1e8))
def test_what_differs_does_not_look_alike(numbers):
    resolved(*numbers)
    texts = figures(*numbers, 1.0)
    for k in (1, 2):
        assert (texts[0] == texts[k]) == same(numbers[0], numbers[k], max(map(abs, numbers)))
    assert texts[1] != texts[2]


@given(intervals(RATES) | intervals(NUMBERS) | intervals(st.floats(-1.0, 1.0)))
def test_the_value_shown_lies_within_the_bounds_shown(numbers):
    resolved(*numbers)
    value, low, high = map(read, figures(*numbers, 1.0))
    assert low[0] <= value[1]
    assert value[0] <= high[1]


@given(intervals(RATES) | intervals(st.floats(-1e5, 1e5)))
def test_never_more_digits_than_the_interval_resolves_and_one(numbers):
    resolved(*numbers)
    assume(max(map(abs, numbers)) >= 1e-4)
    half = (numbers[2] - numbers[1]) / 2
    two_figures = 1 - math.floor(math.log10(half))
    for text in figures(*numbers, 1.0):
        assert decimals(text) <= max(0, two_figures) + 1


@given(intervals(RATES) | intervals(st.floats(-1e5, 1e5)))
def test_a_shown_number_is_near_the_true_one(numbers):
    resolved(*numbers)
    assume(max(map(abs, numbers)) >= 1e-4)
    step = max(10.0 ** -max(map(decimals, figures(*numbers, 1.0))), 0.0)
    for x, text in zip(numbers, figures(*numbers, 1.0), strict=True):
        low, high = read(text)
        assert low - 1.51 * step <= x <= high + 1.51 * step


@given(intervals(RATES))
def test_0_and_1_are_shown_where_they_are_exact(numbers):
    resolved(*numbers)
    for x, text in zip(numbers, figures(*numbers, 1.0), strict=True):
        for end in (0.0, 1.0):
            assert (text == f"{end:.0f}") == same(x, end)
            assert (read(text) == (end, end)) == same(x, end)


@given(RATES)
def test_a_rate_without_an_interval_is_1_only_if_it_is(value):
    text = number(value, 1.0)
    assert (float(text) == 1.0) == (1.0 - value <= 1e-12)
    assert (float(text) == 0.0) == (value <= 1e-12)
    assert abs(float(text) - value) <= 0.051 * min(max(value, 1e-10), max(1.0 - value, 0.1))


@pytest.mark.parametrize(
    ("text", "shown"),
    [("1.25", "+1.25"), ("-0.5", "−0.5"), ("0", "0"), ("0.00", "0.00"), ("-0.00", "0.00"),
     ("<0.01", "<+0.01"), (">-0.01", ">−0.01")],
)  # fmt: skip
def test_differences_have_a_sign(text, shown):
    assert signed(text) == shown


def test_numbers_of_a_column_have_equal_decimals():
    rows = [(0.417, 0.1, 0.7), (0.708, 0.34, 0.95), (0.125, 0.003, 0.548), (0.0, 0.0, 0.5)]
    assert aligned(rows, 1.0) == [
        ("0.42", "0.10", "0.70"), ("0.71", "0.34", "0.95"), ("0.12", "<0.01", "0.55"),
        ("0", "0", "0.50"),
    ]  # fmt: skip
    nan = math.nan
    assert aligned([(675.1, nan, nan), (57.7, nan, nan)]) == [("675.1",), ("57.7",)]
    assert aligned([(0.999, nan, nan), (12.0, nan, nan)], 1.0) == [("1.00",), ("12.00",)]
    assert aligned([(0.002, 0.001, 0.003), (9e8, 8e8, 1e9)]) is None
