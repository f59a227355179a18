"""Entries that rehearsed are never ranked with entries that did not, in any format."""

import csv
import io
import json

import numpy as np
import pytest

from benchnav.leaderboard import NotApplicable, comparisons, leaderboard, render
from benchnav.leaderboard.rendering.prose import render_duel
from benchnav.leaderboard.statistics.head_to_head import duel
from tests.leaderboard.tables import METRICS, row, scores, table

GRANT = {"rehearsal": 5, "rehearsal_decisions": 800, "rehearsal_seconds": 0.0032}


def rows(**grants):
    """Results of two entries without and two with a grant, one of which is better."""
    plain = {"orca": [0.0] * 20, "straight": [0.5] * 20}
    led = {"crowd": [1.0] * 20, "herd": [1.0] * 10 + [0.0] * 10}
    return scores(plain) + scores(led, **{**GRANT, **grants})


@pytest.fixture(scope="module")
def board():
    return leaderboard(table(rows()), METRICS)


def test_ranks_are_among_the_same_grant_alone(board):
    found = {r.navigator: (r.rank_low, r.rank_high, r.ranked, r.rehearsal) for r in board.records}
    assert found == {
        "orca": (2, 2, 2, 0), "straight": (1, 1, 2, 0), "crowd": (1, 1, 2, 5), "herd": (2, 2, 2, 5),
    }  # fmt: skip


def test_a_larger_grant_is_another_one():
    more = table(rows() + scores({"pack": [0.2] * 20}, **{**GRANT, "rehearsal": 6}))
    (record,) = [r for r in leaderboard(more, METRICS).records if r.navigator == "pack"]
    assert (record.ranked, record.note) == (0, "no other entry to rank with")


def test_aggregates_over_scenarios_keep_grants_apart():
    two = rows() + [{**r, "scenario": "trap/u@1", "scenario_hash": "beef"} for r in rows()]
    whole = [r for r in leaderboard(table(two), METRICS).records if r.scenario == "all"]
    assert {(r.navigator, r.ranked) for r in whole} == {
        ("orca", 2), ("straight", 2), ("crowd", 2), ("herd", 2),
    }  # fmt: skip


@pytest.mark.parametrize("format", ["markdown", "latex", "html"])
def test_tables_for_people_have_a_section_of_their_own(board, format):
    text = render(board, format)
    title = "5 rehearsals granted: " if format == "latex" else "20 worlds, rehearsal: 5"
    assert "800 decisions, 3.20 ms" in text
    first, second = text.split(title, 1)
    assert "straight" in first
    assert "crowd" not in first
    assert "crowd" in second
    assert "straight" not in second
    assert "ranked among entries with the same grant alone" in text


def test_many_metrics_below_each_other_show_the_cost(board):
    many = rows() + [row("crowd", s, f"m{k}", 1.0, **GRANT) for s in range(20) for k in range(9)]
    text = render(leaderboard(table(many), METRICS), "markdown", ["all"])
    assert text.count("| rehearsal ") == 1


def test_tidy_formats_say_the_grant_and_its_cost(board):
    told = {r["navigator"]: r for r in json.loads(render(board, "json"))}
    assert told["crowd"]["rehearsal"] == 5
    assert told["crowd"]["rehearsal_decisions"] == 800
    assert told["crowd"]["rehearsal_seconds"] == pytest.approx(0.0032)
    assert (told["orca"]["rehearsal"], told["orca"]["rehearsal_seconds"]) == (0, None)
    lines = {r["navigator"]: r for r in csv.DictReader(io.StringIO(render(board, "csv")))}
    assert (lines["herd"]["rehearsal"], lines["straight"]["rehearsal"]) == ("5", "0")


def test_costs_are_means_over_worlds():
    cheap, dear = rows(rehearsal_decisions=100), rows(rehearsal_decisions=300)
    mixed = [cheap[k] if k % 2 else dear[k] for k in range(len(cheap))]
    found = {r.navigator: r for r in leaderboard(table(mixed), METRICS).records}
    assert found["crowd"].rehearsal_decisions == 200.0
    assert np.isnan(found["orca"].rehearsal_decisions)


def test_what_is_not_applicable_stands_with_its_own_kind():
    cells = [
        NotApplicable("mapper", "leaders/static@1", "unknown", "needs a map"),
        NotApplicable("flock", "leaders/static@1", "unknown", "its leaders' x needs a map", 5),
        NotApplicable("swarm", "leaders/static@1", "unknown", "its leaders' x needs a map", 7),
    ]
    records = leaderboard(table(rows()), METRICS, cells).records
    where = {(r.navigator, r.rehearsal) for r in records if r.note.startswith("n/a")}
    assert where == {("mapper", 0), ("flock", 5), ("swarm", 0), ("swarm", 5)}


def test_a_comparison_across_the_line_never_calls_anybody_better():
    found = duel(table(rows()), METRICS, ["success"], "crowd", "orca")
    (one,) = found.comparisons
    assert (one.difference, one.first_rehearsal, one.second_rehearsal) == (1.0, 5, 0)
    assert (one.verdict, one.adjusted < 1e-3) == ("not as equals", True)
    text = render_duel(found, METRICS)
    assert "## success: not as equals" in text
    assert "crowd succeeds 100 points more often" in text
    assert "crowd 5 and orca none was granted, so neither is called better" in text
    (turned,) = duel(table(rows()), METRICS, ["success"], "orca", "crowd").comparisons
    assert (turned.first_rehearsal, turned.second_rehearsal) == (0, 5)
    every = comparisons(table(rows()), METRICS, "success")
    assert {c.verdict for c in every if c.first_rehearsal != c.second_rehearsal} == {
        "not as equals"
    }
    assert len(every) == 6


def test_results_of_before_there_were_rehearsals_have_none():
    old = table(rows()[:40]).drop_columns(["rehearsal", "rehearsal_decisions", "rehearsal_seconds"])
    assert {r.rehearsal for r in leaderboard(old, METRICS).records} == {0}
