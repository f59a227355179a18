"""The price of ignorance: paired differences between the tracks known and unknown."""

import csv
import io
import json
import math

import pytest

from benchnav.leaderboard import NotApplicable, leaderboard, render
from benchnav.leaderboard.record import IGNORANCE, NO_MAP
from tests.leaderboard.tables import METRICS, scores, table

PRICE = IGNORANCE.mark
SEEDS = 16
PLANNER = {"known": [1.0] * SEEDS, "unknown": [0.5, 1.0, 0.25, 0.25] * (SEEDS // 4)}
BLIND = [0.25, 0.75] * (SEEDS // 2)
GAPS = [NotApplicable("mapper", f"leaders/{name}@1", "unknown", "needs a map") for name in "xy"]


def rows(scenarios=("x", "y")):
    found = []
    for name in scenarios:
        for track, values in PLANNER.items():
            place = {"track": track, "scenario": f"leaders/{name}@1", "scenario_hash": name}
            found += scores({"planner": values, "blind": BLIND}, **place)
            found += scores({"planner": values, "blind": BLIND}, "spl", **place)
            if track == "known":
                found += scores({"mapper": [1.0] * SEEDS}, **place)
    return found


def board(found=None, **more):
    given = {"not_applicable": GAPS, "mapless": {"blind"}, **more}
    return leaderboard(table(rows() if found is None else found), METRICS, **given)


def priced(found, navigator, metric="success", scenario="leaders/x@1"):
    (one,) = [
        r
        for r in found.records
        if (r.track, r.navigator, r.metric, r.scenario) == (PRICE, navigator, metric, scenario)
    ]
    return one


def test_it_is_the_mean_of_the_differences_in_the_same_worlds():
    r = priced(board(), "planner")
    assert r.value == pytest.approx(0.5)
    assert 0.2 < r.low < r.value < r.high < 0.7
    assert (r.episodes, r.defined, r.rank_low, r.ranked, r.note) == (SEEDS, SEEDS, None, 0, "")
    whole = priced(board(), "planner", scenario="all")
    assert whole.value == pytest.approx(0.5)
    assert whole.high - whole.low < r.high - r.low
    assert (whole.episodes, whole.scenario_hash) == (2 * SEEDS, "")


def test_worlds_of_one_track_alone_say_nothing():
    found = [r for r in rows(["x"]) if r["track"] == "known" or r["seed"] < 8]
    r = priced(board(found), "planner")
    assert (r.value, r.episodes) == (pytest.approx(0.5), 8)
    apart = [r for r in rows(["x"]) if (r["track"] == "known") == (r["seed"] < 8)]
    assert not [r for r in board(apart).records if r.track == PRICE]


def test_who_uses_no_map_is_marked_and_who_needs_one_has_none():
    for metric in ("success", "spl"):
        r = priced(board(), "blind", metric)
        assert (r.value, r.note) == (0.0, NO_MAP)
        assert math.isnan(r.low)
    r = priced(board(), "mapper")
    assert (r.episodes, r.note) == (0, "n/a (needs a map)")
    assert math.isnan(r.value)
    assert priced(board(not_applicable=()), "mapper").note == "not run in both tracks"


def test_over_all_scenarios_who_lacks_one_is_told():
    found = [r for r in rows() if not (r["scenario"] == "leaders/y@1" and r["track"] == "unknown")]
    found += [r for r in rows(["y"]) if r["track"] == "unknown" and r["navigator"] == "blind"]
    assert priced(board(found), "planner", scenario="all").note == "in 1 of 2 scenarios"


def test_other_grants_and_worlds_are_never_paired():
    found = [{**r, "rehearsal": 5 * (r["track"] == "known")} for r in rows(["x"])]
    assert not [r for r in board(found).records if r.track == PRICE]
    found = [{**r, "horizon": 60.0 + (r["track"] == "known")} for r in rows(["x"])]
    assert not [r for r in board(found).records if r.track == PRICE]


def test_without_both_tracks_there_is_no_price():
    found = [r for r in rows() if r["track"] == "known"]
    assert "rice of ignorance" not in render(board(found), "markdown")


def test_the_table_in_markdown():
    text = render(board(), "markdown")
    assert text.startswith("## Track known\n\n### all scenarios, track known, leaders, 32 worlds\n")
    assert text.count("## Track ") == 2
    _, tables = text.split("\n## Price of ignorance\n\n")
    assert tables.startswith("### success, known − unknown, leaders, 16 worlds\n")
    lines = [[cell.strip() for cell in line.split("|")[1:-1]] for line in tables.splitlines()[2:7]]
    assert lines[0] == ["navigator", "all scenarios", "leaders/x@1", "leaders/y@1"]
    assert lines[2][0] == "planner"
    assert all(cell.startswith("+0.50 [+0.") for cell in lines[2][1:])
    assert lines[3] == ["blind", "uses no map", "", ""]
    assert lines[4] == ["mapper", "n/a (needs a map)", "", ""]
    assert "### spl, known − unknown" in tables
    assert "price of ignorance: what the same navigator reaches" in tables


@pytest.mark.parametrize(
    ("format", "chapter"),
    [("html", "<h2>Price of ignorance</h2>"), ("latex", "track known less track unknown")],
)
def test_the_table_in_other_formats(format, chapter):
    text = render(board(), format)
    before, after = text.split(chapter)
    assert "+0.50 {[}+0." in after if format == "latex" else "+0.50 [+0." in after
    assert "uses no map" in after
    assert "uses no map" not in before
    assert ("<h2>Track unknown</h2>" if format == "html" else ", track unknown: ") in before


def test_tidy_formats_hold_it_in_the_place_of_a_track():
    found = [r for r in json.loads(render(board(), "json")) if r["track"] == "known - unknown"]
    assert {(r["navigator"], r["scenario"]) for r in found} == {
        (n, s)
        for n in ("planner", "blind", "mapper")
        for s in ("leaders/x@1", "leaders/y@1", "all")
    }
    assert {r["rank_low"] for r in found} == {None}
    read = [r for r in csv.DictReader(io.StringIO(render(board(), "csv"))) if r["track"] == PRICE]
    assert len(read) == len(found)


def test_many_scenarios_stand_in_several_tables():
    text = render(board(rows("abcdefg"), not_applicable=()), "markdown", ["success"])
    _, tables = text.split("## Price of ignorance")
    assert tables.count("### success, known − unknown") == 2
