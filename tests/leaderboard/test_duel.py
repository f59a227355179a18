"""Two navigators against each other."""

import csv
import io
import json
import math

import pytest

from benchnav.errors import UsageError
from benchnav.leaderboard import comparisons
from benchnav.leaderboard.duel import duel, render_duel
from tests.leaderboard.tables import METRICS, scores, table

GOOD, FAIR, BAD = [1.0] * 20, [1.0] * 10 + [0.0] * 10, [0.0] * 20
ROWS = scores({"good": GOOD, "fair": FAIR, "bad": BAD}) + scores(
    {"good": GOOD, "fair": FAIR}, scenario="leaders/other@1"
)


def _words(rows, metric, first, second):
    return render_duel(duel(table(rows), METRICS, metric, first, second), METRICS).splitlines()


def test_a_duel_is_told_in_words():
    lines = _words(ROWS, "success", "bad", "good")
    assert lines[0].startswith(
        "- leaders/static@1, track unknown, leaders, success: bad − good = −1.00 over 20 worlds; p"
    )
    assert lines[0].endswith("bad is significantly worse.")
    assert lines[1] == ""
    lines = _words(ROWS, "success", "good", "fair")
    assert len(lines) == 4
    assert "good − fair = +0.50 [+0.2" in lines[0]
    assert lines[1].endswith("good is significantly better.")


def test_the_order_asked_for_turns_everything_but_p():
    (one,) = duel(table(ROWS[:60]), METRICS, "success", "good", "fair")
    (two,) = duel(table(ROWS[:60]), METRICS, "success", "fair", "good")
    assert (one.difference, one.low, one.high) == (-two.difference, -two.high, -two.low)
    assert (one.p, one.adjusted) == (two.p, two.adjusted)
    every = comparisons(table(ROWS[:60]), METRICS, "success")
    assert len(every) == 3
    assert (
        one.adjusted == next(c for c in every if {c.first, c.second} == {"fair", "good"}).adjusted
    )
    assert one.adjusted > one.p  # the pair is one of three


def test_conditional_metrics_are_higher_not_better_and_may_share_no_world():
    times = {
        "a": [float(10 + k % 3) for k in range(20)],
        "b": [float(2 + k % 2) for k in range(20)],
    }
    (line,) = _words(scores(times, "time_to_goal"), "time_to_goal", "a", "b")[:-2]
    assert line.endswith("a is significantly higher.")
    assert "] s over 20 worlds" in line
    apart = scores({"a": [1.0, math.nan], "b": [math.nan, 2.0]}, "time_to_goal")
    assert (
        "no world in which both a and b have a value" in _words(apart, "time_to_goal", "a", "b")[0]
    )


def test_machines_get_records():
    found = duel(table(ROWS), METRICS, "success", "good", "fair")
    rows = json.loads(render_duel(found, METRICS, "json"))
    read = list(csv.DictReader(io.StringIO(render_duel(found, METRICS, "csv"))))
    assert [r["difference"] for r in rows] == [float(r["difference"]) for r in read] == [0.5, 0.5]
    with pytest.raises(UsageError, match=r"comes as markdown, csv, json. Got 'html'"):
        render_duel(found, METRICS, "html")


def test_wrong_wishes_are_refused():
    with pytest.raises(UsageError, match=r"Got 'goood' instead. Did you mean 'good'"):
        duel(table(ROWS), METRICS, "success", "goood", "bad")
    with pytest.raises(UsageError, match="Got 'good' twice"):
        duel(table(ROWS), METRICS, "success", "good", "good")
    apart = scores({"a": GOOD}, scenario="x@1") + scores({"b": GOOD}, scenario="y@1")
    with pytest.raises(UsageError, match="'a' and 'b' never were"):
        duel(table(apart), METRICS, "success", "a", "b")
