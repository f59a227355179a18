"""Success against time, from episodes."""

import csv
import io
import json
import re
from dataclasses import replace

import pytest

from benchnav.errors import UsageError
from benchnav.leaderboard import leaderboard
from benchnav.leaderboard.rendering.curve_table import render_curves
from benchnav.leaderboard.statistics.curve import Setting, horizon_curves, parameter_curves
from benchnav.testing import episodes as made
from benchnav.testing.episodes import Hit, Walk, record, straight
from tests.leaderboard.tables import METRICS, scores, table


def _episode(seed, *speeds, navigator="a", track="known", hits=(), **identity):
    """Agents that go 5 m (arriving 0.2 m before) at their speeds; the first may hit something."""
    walks = [
        Walk(straight((0.0, 3.0 * n), (v, 0.0)), (5.0, 3.0 * n), hits=hits if n == 0 else ())
        for n, v in enumerate(speeds)
    ]
    found = record(walks, made.Setting(horizon=10.0))
    who = replace(found.identity, seed=seed, navigator=navigator, track=track, **identity)
    return replace(found, identity=who)


def _shares(points, **where):
    chosen = [p for p in points if all(getattr(p, k) == v for k, v in where.items())]
    return [p.value for p in chosen]


def test_failures_stay_in_the_denominator():
    """Arrivals at 2.4 s and 4.8 s; one that never moves; one that hits something on its way."""
    episodes = [_episode(0, 2.0, 1.0), _episode(1, 0.0, 0.0), _episode(2, 2.0, 0.0, hits=(Hit(1),))]
    points = horizon_curves(episodes, 5)
    assert [p.x for p in points] == [2.0, 4.0, 6.0, 8.0, 10.0]
    assert _shares(points) == pytest.approx([0.0, 1 / 6, 2 / 6, 2 / 6, 2 / 6])
    assert {(p.metric, p.axis, p.axis_unit, p.worlds) for p in points} == {
        ("success", "horizon", "s", 3)
    }
    assert all(p.low <= p.value <= p.high for p in points)


def test_navigators_tracks_and_scenarios_stand_apart_and_repeats_count_once():
    episodes = [
        _episode(0, 2.0), _episode(1, 0.0), _episode(0, 2.0), _episode(0, 0.0, navigator="b"),
        _episode(0, 2.0, track="unknown"), _episode(0, 0.0, scenario_hash="other"),
    ]  # fmt: skip
    points = horizon_curves(episodes, 1)
    found = [(p.track, p.scenario_hash, p.navigator, p.value, p.worlds) for p in points]
    assert found == [
        ("known", "00000000", "a", 0.5, 2), ("known", "00000000", "b", 0.0, 1),
        ("known", "other", "a", 0.0, 1), ("unknown", "00000000", "a", 1.0, 1),
    ]  # fmt: skip


def test_a_curve_ends_at_the_success_of_the_table():
    episodes = [_episode(seed, 2.0, 1.0 if seed % 3 else 0.0) for seed in range(12)]
    rows = scores({"a": [1.0 if seed % 3 else 0.5 for seed in range(12)]})
    known = leaderboard(table([{**r, "defined": 2} for r in rows]), METRICS).records[0]
    last = horizon_curves(episodes, 4)[-1]
    assert (last.value, last.low, last.high) == pytest.approx((known.value, known.low, known.high))


def test_a_curve_is_a_table_for_people_and_records_for_machines():
    episodes = [_episode(0, 2.0), _episode(1, 0.0), _episode(0, 0.0, navigator="b|")]
    points = horizon_curves(episodes)
    text = render_curves(points, "markdown")
    assert text.startswith(
        "### synthetic/walks@1, track known, leaders\n\n"
        "| success by horizon | 1 s | 2 s | 3 s  | 4 s  "
    )
    assert "| a                  | 0   | 0   | 0.50 | 0.50 " in text
    assert r"| b\|" in text
    rows = json.loads(render_curves(points, "json"))
    assert len(rows) == 200
    read = list(csv.DictReader(io.StringIO(render_curves(points, "csv"))))
    assert [float(r["value"]) for r in read] == [r["value"] for r in rows]
    with pytest.raises(UsageError, match=r"comes as markdown, csv, json. Got 'latex'"):
        render_curves(points, "latex")


FAR = {f"leaders/s@1:far={x}": Setting("leaders/s@1", float(x), "m") for x in (2, 10, 0)}


def test_a_metric_against_a_parameter_is_the_table_in_the_order_of_the_parameter():
    rows = scores({"a": [1.0] * 8, "b": [1.0] * 8}, scenario="leaders/other@1")
    for name, where in FAR.items():
        values = {"a": [1.0 - where.x / 10] * 8, "b": [0.5, 1.0] * 4}
        rows += scores(values, scenario=name, scenario_hash=name)
    points = parameter_curves(table(rows), METRICS["success"], "far", FAR)
    assert [(p.navigator, p.x, round(p.value, 9)) for p in points] == [
        ("a", 0.0, 1.0), ("a", 2.0, 0.8), ("a", 10.0, 0.0),
        ("b", 0.0, 0.75), ("b", 2.0, 0.75), ("b", 10.0, 0.75),
    ]  # fmt: skip
    assert {(p.scenario, p.axis, p.axis_unit) for p in points} == {("leaders/s@1", "far", "m")}
    board = {
        (r.navigator, r.scenario): (r.value, r.low, r.high)
        for r in leaderboard(table(rows), METRICS).records
    }
    for p in points:
        assert (p.value, p.low, p.high) == board[p.navigator, f"leaders/s@1:far={p.x:g}"]
    text = render_curves(points, "markdown")
    assert "### leaders/s@1, track unknown, leaders, 8 worlds" in text
    assert re.search(r"\| success by far \| 0 m +\| 2 m +\| 10 m +\|", text)
    assert "| 0.80 [0." in text
