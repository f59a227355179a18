"""Two navigators against each other: one family, ties, and what cannot be compared."""

import csv
import io
import json
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchnav.errors import UsageError
from benchnav.leaderboard import NotApplicable, comparisons
from benchnav.leaderboard.rendering.prose import render_duel
from benchnav.leaderboard.statistics.comparison import least_worlds
from benchnav.leaderboard.statistics.difference import least_p
from benchnav.leaderboard.statistics.head_to_head import duel
from benchnav.leaderboard.statistics.significance import holm
from tests.leaderboard.tables import METRICS, scores, simulated, table

GOOD, FAIR, BAD = [1.0] * 20, [1.0] * 10 + [0.0] * 10, [0.0] * 20
ROWS = scores({"good": GOOD, "fair": FAIR, "bad": BAD}) + scores(
    {"good": GOOD, "fair": FAIR}, scenario="leaders/other@1"
)


def met(rows, first, second, *names, gaps=()):
    return duel(table(rows), METRICS, names or ("success",), first, second, gaps)


def words(rows, first, second, *names):
    text = render_duel(met(rows, first, second, *names), METRICS).split("[low, high]: ")[0]
    return [line for line in text.splitlines() if line.startswith("- ")]


def test_a_difference_is_told_in_words():
    (line,) = words(ROWS, "bad", "good")
    assert line.startswith(
        "- leaders/static@1, track unknown (20 worlds): bad succeeds 100 points less often [85, "
    )
    assert line.endswith("; by chance less than once in 10,000 times.")
    lines = words(ROWS, "good", "fair")
    assert len(lines) == 3
    assert "good succeeds 50 points more often [25, 75]" in lines[0]
    assert lines[2].startswith("- all scenarios, track unknown (40 worlds): good succeeds 50 ")


def test_a_side_that_is_declared_is_named():
    """Times of arrivals are higher and worse, for text and figure alike."""
    rows = scores({"a": [9.0] * 20, "b": [5.0] * 20}, "time_to_goal")
    rows += scores({"a": [2.0] * 20, "b": [5.0] * 20}, "turning")
    found = met(rows, "a", "b", "time_to_goal", "turning")
    slow, steady = render_duel(found, METRICS).split("[low, high]: ")[0].split("## ")[1:]
    assert slow.startswith("time_to_goal: worse")
    assert "time_to_goal of a is 4.0 s higher" in slow
    assert "(worse, among agents that arrive); by chance" in slow
    assert "(better); by chance" in steady
    assert {c.verdict for c in found.comparisons} == {"worse", "better"}


def test_ties_and_too_few_worlds_are_called_what_they_are():
    rng = np.random.default_rng(0)
    tied = {"a": rng.integers(0, 2, 40), "b": rng.integers(0, 2, 40)}
    (line,) = words(scores(tied), "a", "b")
    assert ": a tie, a − b = " in line
    (line,) = words(scores({"a": GOOD, "b": GOOD}), "a", "b")
    assert line.endswith(": a tie, a − b = 0 points [−15, +15].")
    (line,) = words(scores({"a": [1.0] * 4, "b": [0.0] * 4}), "a", "b")
    assert ": too few worlds to tell, a − b = +100 points [" in line
    few = {"a": [1.0] * 5, "b": [0.0] * 5}  # p = 0.024: enough alone, and not one of three
    assert met(scores(few), "a", "b").comparisons[0].verdict == "better"
    three = ("success", "spl", "collided")
    rows = [r for name in three for r in scores(few, name)]
    assert {c.verdict for c in met(rows, "a", "b", *three).comparisons} == {"too few worlds"}


def test_all_that_is_said_is_one_family():
    rows = simulated(["a", "b"], 3, 12, np.random.default_rng(5), tracks=("known", "unknown"))
    found = met(rows, "a", "b", "success", "collided", "spl").comparisons
    assert len(found) == 3 * 2 * (3 + 1)
    assert {c.family for c in found} == {24}
    assert [c.adjusted for c in found] == pytest.approx(holm(np.array([c.p for c in found])))
    assert [c.metric for c in found] == ["success"] * 8 + ["collided"] * 8 + ["spl"] * 8


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 4), st.integers(1, 9), st.integers(0, 2**32))
def test_alone_a_difference_is_what_its_interval_says(scenarios, seeds, seed):
    rows = simulated(["a", "b"], scenarios, seeds, np.random.default_rng(seed))
    for name in ("success", "spl", "turning", "time_to_goal"):
        for c in met(rows, "a", "b", name).comparisons:
            assert (c.p < 0.05) == (c.low > 0.0 or c.high < 0.0)
            assert c.adjusted >= c.p


def test_a_metric_without_a_value_anywhere_is_said_and_no_error():
    none = {"a": [math.nan] * 6, "b": [math.nan] * 6}
    rows = scores(none, "time_to_goal") + scores(none, "time_to_goal", scenario="x@1")
    lines = words(rows, "a", "b", "time_to_goal")
    assert len(lines) == 3
    assert all(line.endswith("(0 worlds): no world in which both have a value.") for line in lines)
    part = scores({"a": [1.0, math.nan], "b": [math.nan, 2.0]}, "time_to_goal", scenario="x@1")
    both = part + scores({"a": [3.0, 4.0], "b": [1.0, 2.5]}, "time_to_goal")
    whole = met(both, "a", "b", "time_to_goal").comparisons[-1]
    assert (whole.scenario, whole.worlds, whole.difference) == ("all", 2, 1.75)


def test_over_all_scenarios_each_counts_alike():
    rows = scores({"a": [1.0] * 40, "b": [0.0] * 40}) + scores(
        {"a": [0.0] * 10, "b": [0.0] * 10}, scenario="leaders/other@1"
    )
    whole = met(rows, "a", "b").comparisons[-1]
    assert (whole.scenario, whole.difference, whole.worlds) == ("all", 0.5, 50)
    assert whole.low < 0.5 < whole.high


def test_the_order_asked_for_turns_everything_but_p():
    rows = simulated(["a", "b"], 2, 15, np.random.default_rng(8))
    names = ("success", "spl", "turning", "time_to_goal")
    one, two = (met(rows, *pair, *names).comparisons for pair in (("a", "b"), ("b", "a")))
    for x, y in zip(one, two, strict=True):
        assert x.difference == pytest.approx(-y.difference)
        assert (x.p, x.adjusted, x.worlds) == pytest.approx((y.p, y.adjusted, y.worlds))
        assert (x.low, x.high) == pytest.approx((-y.high, -y.low))
        assert {x.verdict, y.verdict} in ({"tie"}, {"better", "worse"}, {"higher", "lower"})


def test_every_pair_of_a_table_is_a_family_of_its_own():
    every = comparisons(table(ROWS[:60]), METRICS, "success")
    assert [c.family for c in every] == [3, 3, 3]
    assert all(c.adjusted >= c.p for c in every)


def test_conditional_metrics_are_higher_not_better_and_may_share_no_world():
    times = {
        "a": [float(10 + k % 3) for k in range(20)],
        "b": [float(2 + k % 2) for k in range(20)],
    }
    (line,) = words(scores(times, "time_to_goal"), "a", "b", "time_to_goal")
    assert "time_to_goal of a is 8.4 s higher [8.0, 8.9]" in line
    assert "better" not in line
    apart = scores({"a": [1.0, math.nan], "b": [math.nan, 2.0]}, "time_to_goal")
    (line,) = words(apart, "a", "b", "time_to_goal")
    assert line.endswith("(0 worlds): no world in which both have a value.")
    found = met(scores(times, "time_to_goal") + scores(times, "turning"), "a", "b", "turning")
    assert found.comparisons[0].verdict == "worse"


def test_what_cannot_be_compared_is_said():
    rows = scores({"a": GOOD, "b": FAIR})
    rows += scores({"a": GOOD}, track="known") + scores({"a": GOOD}, scenario="x@1")
    rows += scores({"a": GOOD}, scenario="y@1") + scores({"b": GOOD}, scenario="y@1", horizon=9.0)
    rows += scores({"a": GOOD, "b": [*GOOD[:8], *[None] * 12]}, scenario="z@1")
    rows[25]["failure"] = "raised ValueError"
    gaps = [NotApplicable("b", "leaders/static@1", "known", "needs a map")]
    notes = met(rows, "a", "b", gaps=gaps).notes
    assert "Only a in leaders/static@1 (known): b needs a map." in notes
    assert "Only a in x@1 (unknown): b was not run there." in notes
    other = "ran other worlds: horizon, time step or hash differ"
    assert f"Only a in y@1 (unknown): b {other}." in notes
    assert "z@1 (unknown): a in 20 and b in 8 worlds, compared in the 8 of both." in notes
    assert any("b failed in 1 world" in note for note in notes)
    text = render_duel(met(rows, "a", "b", gaps=gaps), METRICS)
    assert all(note in text for note in notes)


def test_machines_get_records():
    found = met(ROWS, "good", "fair")
    rows = json.loads(render_duel(found, METRICS, "json"))
    read = list(csv.DictReader(io.StringIO(render_duel(found, METRICS, "csv"))))
    assert [r["difference"] for r in rows] == [float(r["difference"]) for r in read] == [0.5] * 3
    assert [r["verdict"] for r in read] == ["better"] * 3
    with pytest.raises(UsageError, match=r"comes as markdown, csv, json. Got 'html'"):
        render_duel(found, METRICS, "html")


def test_wrong_wishes_are_refused():
    with pytest.raises(UsageError, match=r"Got 'goood' instead. Did you mean 'good'"):
        met(ROWS, "goood", "bad")
    with pytest.raises(UsageError, match="Got 'good' twice"):
        met(ROWS, "good", "good")
    apart = scores({"a": GOOD}, scenario="x@1") + scores({"b": GOOD}, scenario="y@1")
    with pytest.raises(UsageError, match=r"'a' and 'b' never were. Only a in x@1"):
        met(apart, "a", "b")
    other = scores({"a": GOOD}, horizon=9.0) + scores({"b": GOOD})
    with pytest.raises(UsageError, match="ran other worlds"):
        met(other, "a", "b")


@pytest.mark.parametrize("family", [1, 12, 400])
def test_fewer_worlds_than_the_least_show_no_difference(family):
    worlds = least_worlds(family)
    assert family * least_p(worlds) < 0.05 <= family * least_p(worlds - 1)
