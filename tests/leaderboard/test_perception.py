"""Results of exact and noisy perception are never mixed; their difference is the price of noise."""

import csv
import io
import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchnav.leaderboard import NotApplicable, comparisons, leaderboard, render
from benchnav.leaderboard.record import ALL, IGNORANCE, NO_MAP, NOISE
from benchnav.leaderboard.rendering.prose import render_duel
from benchnav.leaderboard.statistics.all_pairs import duels, notes_by_condition
from benchnav.leaderboard.statistics.curve import Setting, parameter_curves, place
from benchnav.leaderboard.statistics.head_to_head import duel
from tests.leaderboard.tables import METRICS, scores, simulated, table

SEEDS = 16
VALUES = {
    "exact": {"steady": [1.0] * SEEDS, "shaky": [0.75, 1.0] * (SEEDS // 2)},
    "noisy": {"steady": [1.0] * SEEDS, "shaky": [0.25, 0.5, 0.25, 0.0] * (SEEDS // 4)},
}


def rows(scenarios=("x", "y"), tracks=("known",)):
    found = []
    for name in scenarios:
        for perception, values in VALUES.items():
            for track in tracks:
                where = {"scenario": f"leaders/{name}@1", "scenario_hash": name, "track": track}
                found += scores(values, perception=perception, **where)
    return found


def board(found=None, **more):
    return leaderboard(table(rows() if found is None else found), METRICS, **more)


def priced(found, navigator, scenario="leaders/x@1", track="known"):
    wanted = NOISE, navigator, scenario, track
    (one,) = [r for r in found.records if (r.price, r.navigator, r.scenario, r.track) == wanted]
    return one


def test_each_perception_has_tables_of_its_own():
    text = render(board(), "markdown")
    assert text.startswith("## Track known\n\n### all scenarios, track known, leaders, 32 worlds\n")
    assert (
        "## Track known, noisy perception\n\n### all scenarios, track known, noisy perception,"
        in text
    )
    exact, noisy = text.split("## Track known, noisy perception")
    assert "0.88 [" in exact
    assert "0.25 [" in noisy.split("## Price of noise")[0]


def test_ranks_and_means_are_those_of_one_perception():
    both, alone = board(), board([r for r in rows() if r["perception"] == "noisy"])
    noisy = [r for r in both.records if r.perception == "noisy"]
    assert repr(noisy) == repr(list(alone.records))  # NaN differs from itself
    assert {r.ranked for r in noisy} == {2}


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32), st.booleans())
def test_noisy_rows_change_no_exact_record(seed, reverse):
    rng = np.random.default_rng(seed)
    exact = simulated(["a", "b"], 2, 5, rng, tracks=("known", "unknown"))
    noisy = [{**r, "perception": "noisy"} for r in simulated(["a", "b"], 2, 5, rng)]
    mixed = [*noisy, *exact] if reverse else [*exact, *noisy]
    found = leaderboard(table(mixed), METRICS).records
    alone = leaderboard(table(exact), METRICS).records
    assert repr([r for r in found if r.perception == "exact"]) == repr(list(alone))
    assert all(r.perception == NOISE.mark for r in found if r.price == NOISE)
    assert {r.track for r in found if r.price == NOISE} == {"unknown"}


def test_the_price_of_noise_is_the_mean_of_the_differences_in_the_same_worlds():
    r = priced(board(), "shaky")
    apart = np.subtract(VALUES["exact"]["shaky"], VALUES["noisy"]["shaky"])
    assert r.value == pytest.approx(apart.mean())
    assert r.low < r.value < r.high
    assert (r.perception, r.episodes, r.ranked, r.note) == ("exact - noisy", SEEDS, 0, "")
    whole = priced(board(), "shaky", ALL)
    assert whole.high - whole.low < r.high - r.low
    assert priced(board(), "steady").value == 0.0


def test_worlds_of_one_perception_alone_are_not_paired():
    found = [r for r in rows(["x"]) if r["perception"] == "exact" or r["seed"] < 8]
    assert priced(board(found), "shaky").episodes == 8
    apart = [r for r in rows(["x"]) if (r["perception"] == "exact") == (r["seed"] < 8)]
    assert not [r for r in board(apart).records if r.price]


def test_a_navigator_with_one_perception_has_the_reason_for_no_price():
    found = [r for r in rows(["x"]) if (r["navigator"], r["perception"]) != ("shaky", "noisy")]
    assert priced(board(found), "shaky").note == "not run in both perceptions"
    gap = NotApplicable("shaky", "leaders/x@1", "known", "needs ears", perception="noisy")
    assert priced(board(found, not_applicable=[gap]), "shaky").note == "n/a (needs ears)"


def test_tracks_have_prices_of_noise_and_perceptions_have_prices_of_ignorance():
    found = board(rows(tracks=("known", "unknown")), mapless={"steady"})
    assert priced(found, "shaky", track="unknown").value == priced(found, "shaky").value > 0
    ignorance = [r for r in found.records if r.price == IGNORANCE]
    assert {r.perception for r in ignorance} == {"exact", "noisy"}
    assert {r.note for r in ignorance if r.navigator == "steady"} == {NO_MAP}
    text = render(found, "markdown")
    assert "### success, known − unknown, leaders, 16 worlds" in text
    assert "### success, known − unknown, noisy perception, leaders, 16 worlds" in text
    assert "### success, exact − noisy, track unknown, leaders, 16 worlds" in text


def test_the_table_of_the_price_of_noise():
    _, tables = render(board(), "markdown").split("\n## Price of noise\n\n")
    assert tables.startswith("### success, exact − noisy, track known, leaders, 16 worlds\n")
    lines = [[cell.strip() for cell in line.split("|")[1:-1]] for line in tables.splitlines()[2:6]]
    assert lines[0] == ["navigator", "all scenarios", "leaders/x@1", "leaders/y@1"]
    assert lines[2][0] == "shaky"
    assert all(cell.startswith("+0.62 [+0.") for cell in lines[2][1:])
    assert "price of noise: what the same navigator reaches with exact perception less" in tables


@pytest.mark.parametrize(
    ("format", "chapter"),
    [
        ("html", "<h2>Price of noise</h2>"),
        ("latex", "track known less track known, noisy perception"),
        ("terminal", "Price of noise"),
    ],
)
def test_the_table_in_other_formats(format, chapter, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    text = render(board(), format)
    assert "+0.62" in text.split(chapter, 1)[1]
    assert format != "terminal" or max(map(len, text.splitlines())) <= 80
    if format == "latex":
        labels = [line for line in text.splitlines() if "\\label" in line]
        assert len(set(labels)) == len(labels) == 3


def test_exact_results_say_nothing_about_perception():
    text = render(board([r for r in rows() if r["perception"] == "exact"]), "markdown")
    assert "perception" not in text
    assert "oise" not in text


def test_tidy_formats_have_a_column():
    for found in (
        json.loads(render(board(), "json")),
        list(csv.DictReader(io.StringIO(render(board(), "csv")))),
    ):
        assert {r["perception"] for r in found} == {"exact", "noisy", "exact - noisy"}


def test_comparisons_are_made_within_a_perception():
    found = comparisons(table(rows()), METRICS, "success")
    assert {(c.scenario, c.perception, c.worlds) for c in found} == {
        (f"leaders/{s}@1", p, SEEDS) for s in "xy" for p in ("exact", "noisy")
    }
    one = duel(table(rows()), METRICS, ["success"], "shaky", "steady")
    assert {c.perception for c in one.comparisons if c.scenario == ALL} == {"exact", "noisy"}
    assert "all scenarios, track known, noisy perception (32 worlds)" in render_duel(one, METRICS)
    (again,) = duels(table(rows()), METRICS, ["success"])
    assert sorted(map(repr, again.comparisons)) == sorted(map(repr, one.comparisons))


def test_what_only_one_was_run_in_names_the_perception():
    found = table(
        [r for r in rows(["x"]) if (r["navigator"], r["perception"]) != ("shaky", "noisy")]
    )
    text = "Only steady in leaders/x@1 (known, noisy): shaky was not run there."
    assert text in duel(found, METRICS, ["success"], "shaky", "steady").notes
    notes = notes_by_condition(found, METRICS, [("known", "exact"), ("known", "noisy")])
    assert notes["shaky", "steady"] == [[], [text]]


def test_curves_of_two_perceptions_are_apart():
    where = {f"leaders/{s}@1": Setting("leaders", float(x), "m") for x, s in enumerate("xy")}
    points = parameter_curves(table(rows()), METRICS["success"], "far", where)
    assert len({place(p) for p in points}) == 2
    assert {p.perception for p in points} == {"exact", "noisy"}
