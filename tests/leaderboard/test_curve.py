"""Success against time, from episodes."""

import csv
import io
import json
from dataclasses import replace

import pytest

from benchnav.errors import UsageError
from benchnav.leaderboard.curve import render_curves, success_curves
from benchnav.testing.episodes import Hit, Setting, Walk, record, straight


def _episode(seed, *speeds, navigator="a", track="known", hits=(), **identity):
    """Agents that go 5 m (arriving 0.2 m before) at their speeds; the first may hit something."""
    walks = [
        Walk(straight((0.0, 3.0 * n), (v, 0.0)), (5.0, 3.0 * n), hits=hits if n == 0 else ())
        for n, v in enumerate(speeds)
    ]
    found = record(walks, Setting(horizon=10.0))
    who = replace(found.identity, seed=seed, navigator=navigator, track=track, **identity)
    return replace(found, identity=who)


def _shares(points, **where):
    chosen = [p for p in points if all(getattr(p, k) == v for k, v in where.items())]
    return [p.share for p in chosen]


def test_failures_stay_in_the_denominator():
    """Arrivals at 2.4 s and 4.8 s; one that never moves; one that hits something on its way."""
    episodes = [_episode(0, 2.0, 1.0), _episode(1, 0.0, 0.0), _episode(2, 2.0, 0.0, hits=(Hit(1),))]
    points = success_curves(episodes, 5)
    assert [p.time for p in points] == [2.0, 4.0, 6.0, 8.0, 10.0]
    assert _shares(points) == pytest.approx([0.0, 1 / 6, 2 / 6, 2 / 6, 2 / 6])
    assert {(p.agents, p.worlds) for p in points} == {(6, 3)}


def test_navigators_tracks_and_scenarios_stand_apart_and_repeats_count_once():
    episodes = [
        _episode(0, 2.0), _episode(1, 0.0), _episode(0, 2.0), _episode(0, 0.0, navigator="b"),
        _episode(0, 2.0, track="unknown"), _episode(0, 0.0, scenario_hash="other"),
    ]  # fmt: skip
    points = success_curves(episodes, 1)
    found = [(p.track, p.scenario_hash, p.navigator, p.share, p.worlds) for p in points]
    assert found == [
        ("known", "00000000", "a", 0.5, 2), ("known", "00000000", "b", 0.0, 1),
        ("known", "other", "a", 0.0, 1), ("unknown", "00000000", "a", 1.0, 1),
    ]  # fmt: skip


def test_a_curve_is_a_table_for_people_and_records_for_machines():
    episodes = [_episode(0, 2.0), _episode(1, 0.0), _episode(0, 0.0, navigator="b|")]
    text = render_curves(episodes, "markdown")
    assert text.startswith(
        "### synthetic/walks@1, track known, leaders, 2 worlds\n\n"
        "| navigator | 1 s | 2 s | 3 s  | 4 s  "
    )
    assert "| a         | 0   | 0   | 0.50 | 0.50 " in text
    assert r"| b\|" in text
    rows = json.loads(render_curves(episodes, "json"))
    assert len(rows) == 200
    read = list(csv.DictReader(io.StringIO(render_curves(episodes, "csv"))))
    assert [float(r["share"]) for r in read] == [r["share"] for r in rows]
    with pytest.raises(UsageError, match=r"comes as markdown, csv, json. Got 'latex'"):
        render_curves(episodes, "latex")
