"""What navigators remark, and why they failed, stands beside the table in every format."""

import csv
import io
import json
from itertools import product

import pytest

from benchnav.leaderboard.rendering.formats import render
from benchnav.leaderboard.table import leaderboard
from benchnav.store.parts.results import RESULTS, completed
from tests.leaderboard.tables import METRICS, row, table

LOST = "the planner found no path: no path was found within the budget"


def board(rows):
    return leaderboard(table(rows), METRICS)


@pytest.fixture
def rows():
    """Two scenarios of 20 worlds: navmesh finds all, prm misses 12 in one of them."""
    made = []
    for scenario, name in product(("a/one@1", "b/two@1"), ("navmesh+orca", "ompl.prm+orca")):
        lost = (scenario, name) == ("a/one@1", "ompl.prm+orca")
        for seed, metric in product(range(20), ("success", "spl")):
            told = [LOST] if lost and seed < 12 else []
            value = 1.0 - bool(told)
            made.append(row(name, seed, metric, value, scenario=scenario, remarks=told))
    return made


def test_remarks_are_counted_in_worlds_not_in_rows(rows):
    found = {
        (r.navigator, r.scenario): r.remark for r in board(rows).records if r.metric == "success"
    }
    assert found["ompl.prm+orca", "a/one@1"] == f"in 12 of 20 worlds: {LOST}"
    assert found["ompl.prm+orca", "b/two@1"] == ""
    assert found["ompl.prm+orca", "all"] == f"in 12 of 40 worlds: {LOST}"
    assert {text for (name, _), text in found.items() if name == "navmesh+orca"} == {""}


def test_a_world_counts_once_for_remarks_that_differ_in_numbers():
    both = [f"the leader of team {team} succeeded in none of 5 rehearsals" for team in (0, 1)]
    rows = [row("guided-crowd", seed, "success", 1.0, remarks=both) for seed in range(3)]
    (found,) = {r.remark for r in board(rows).records}
    assert found == f"in 3 of 3 worlds: {both[0]}"


@pytest.mark.parametrize("format", ["markdown", "latex", "html"])
def test_tables_for_people_tell_them_below(rows, format):
    text = render(board(rows), format)
    in_one_scenario = 0 if format == "latex" else 1  # its matrix holds all scenarios
    assert text.count(f"in 12 of 20 worlds: {LOST}.") == in_one_scenario
    assert text.count(f"in 12 of 40 worlds: {LOST}.") == 1


def test_tidy_records_hold_them(rows):
    told = f"in 12 of 40 worlds: {LOST}"
    records = json.loads(render(board(rows), "json"))
    assert {r["remark"] for r in records if r["scenario"] == "all"} == {told, ""}
    lines = csv.DictReader(io.StringIO(render(board(rows), "csv")))
    assert {r["remark"] for r in lines if r["scenario"] == "all"} == {told, ""}


def test_failures_of_one_fault_are_told_once():
    reasons = [f"act raised IndexError: index {k} (a.py:3) at t = {k} s" for k in range(5)]
    rows = [row("x", k, "success", 0.0, failure=why) for k, why in enumerate([*reasons, "", ""])]
    (record,) = board(rows).records
    assert record.failure == "in 5 of 7 worlds: act raised IndexError: index 0 (a.py:3)"
    assert "x failed in 5 of 7 worlds: act raised IndexError: " in render(board(rows), "markdown")


def test_many_remarks_are_cut_and_none_acts_in_html():
    rows = [
        row("x", k, "success", 1.0, remarks=[f"<script>{word}"])
        for k, word in enumerate(("one", "two", "three", "four", "five"))
    ]
    (record,) = board(rows).records
    assert record.remark.count("in 1 of 5 worlds: ") == 3
    assert record.remark.endswith("; and 2 more")
    assert "<script>" not in render(board(rows), "html")


def test_results_of_older_runs_have_no_remarks():
    older = table([row("x", 0, "success", 1.0)]).drop_columns(["remarks", "traceback"])
    assert leaderboard(older, METRICS).records[0].remark == ""
    whole = completed(older).cast(RESULTS)
    assert leaderboard(whole, METRICS).records[0].remark == ""
