"""The numbers behind figures: from made-up results and hand-made episodes with known answers."""

from dataclasses import replace

import numpy as np
import pytest

import benchnav
from benchnav.arena.solid import Kind
from benchnav.leaderboard import leaderboard
from benchnav.leaderboard.from_runs import curve, stored_values
from benchnav.leaderboard.record import ALL, IGNORANCE, NO_MAP
from benchnav.leaderboard.statistics.curve import horizon_curves
from benchnav.report.analysis.configuration import facts_of, parameters_of, training_text
from benchnav.report.analysis.cost import costs
from benchnav.report.analysis.episode_summary import summarise
from benchnav.report.analysis.failures import outcome_shares, partners
from benchnav.report.analysis.horizon import HorizonCurves
from benchnav.report.analysis.outcome import Outcome
from benchnav.report.analysis.parameter import ParameterCurves
from benchnav.report.analysis.price import price_sentence, prices_of
from benchnav.report.analysis.profile import profile
from benchnav.report.analysis.scenario_facts import scenario_facts
from benchnav.report.analysis.view import View, title_of, views_of
from benchnav.report.figures.price import price_figure
from benchnav.report.line_style import LineStyle
from benchnav.testing.episodes import Hit, Setting, Walk, record, straight
from tests.leaderboard.tables import METRICS, scores, simulated, table

KNOWN, UNKNOWN = View("test", "known", "leader"), View("test", "unknown", "leader")


def _episode(seed, *hits, navigator="a", scenario="trap/u@1", speed=1.0):
    """Two agents on parallel lines; the first one has these hits."""
    walks = [
        Walk(straight((0.0, 3.0 * n), (speed, 0.0)), (5.0, 3.0 * n), hits=hits if n == 0 else ())
        for n in range(2)
    ]
    found = record(walks, Setting(horizon=10.0))
    identity = replace(found.identity, seed=seed, navigator=navigator, scenario=scenario)
    return replace(found, identity=identity)


def test_shares_are_means_over_worlds_and_repeated_episodes_count_once():
    hit = Hit(1.0, partner=1, kind=Kind.AGENT)
    episodes = [_episode(0, hit), _episode(0, hit), _episode(1), _episode(2)]
    found = [summarise(e, ("known",)) for e in episodes]
    shares = outcome_shares(found, KNOWN)["trap/u@1"]["a"]
    assert shares.worlds == 3
    assert shares[Outcome.SUCCESS] == pytest.approx(5 / 6)
    assert shares[Outcome.HIT_AGENT] == pytest.approx(1 / 6)
    assert sum(shares.shares) == pytest.approx(1.0)
    assert outcome_shares(found, UNKNOWN) == {}


def test_an_episode_counts_in_every_track_that_it_stands_for():
    found = [summarise(_episode(0, speed=0.0), ("known", "unknown"))]
    assert outcome_shares(found, UNKNOWN)["trap/u@1"]["a"].worlds == 1


def test_partners_are_counted_by_navigator_and_rare_ones_are_added_up():
    agent, rare = Hit(1.0, kind=Kind.AGENT, partner=1), Hit(1.0, kind=Kind.AGENT, partner=1)
    episodes = [_episode(0, agent), _episode(1, agent), _episode(1, rare, navigator="b")]
    found = [summarise(e, ("known",)) for e in episodes]
    assert partners(found, KNOWN, 5, ()) == {"another leader": {"a": 2, "b": 1}}
    assert partners(found, KNOWN, 0, ()) == {"1 other": {"a": 2, "b": 1}}


def test_curves_of_a_view_are_those_of_the_command_line():
    episodes = [_episode(seed, speed=1.0 + seed) for seed in range(3)]
    episodes.append(_episode(0, navigator="b", speed=0.8))
    found = [
        summarise(e, ("known", "unknown") if e.identity.navigator == "a" else ("known",))
        for e in episodes
    ]
    curves = HorizonCurves(found)
    assert curves.panels(KNOWN) == [list(horizon_curves(episodes))]
    (unknown,) = curves.panels(UNKNOWN)
    assert unknown == [p for p in horizon_curves(episodes) if p.navigator == "a"]
    assert curves.panels(View("test", "known", "follower")) == []


def _records(rows, **options):
    return leaderboard(table(rows), METRICS, **options).records


def test_a_profile_has_the_means_of_the_leaderboard_of_each_family():
    rows = simulated(["a", "b"], 3, 6, np.random.default_rng(1))
    families = {"one": ["leaders/s0@1", "leaders/s2@1"], "two": ["leaders/s1@1"], "none": ["x"]}
    found = profile(table(rows), METRICS, "success", families)[UNKNOWN]
    assert set(found) == {"one", "two"}
    alone = _records([r for r in rows if r["scenario"] in families["one"]])
    (mean,) = (r for r in alone if (r.scenario, r.navigator, r.metric) == (ALL, "b", "success"))
    assert (found["one"]["b"].value, found["one"]["b"].low) == (mean.value, mean.low)
    assert found["two"]["a"].scenario == "leaders/s1@1"


def test_views_are_in_the_order_of_tracks_and_named_by_what_differs():
    rows = simulated(["a", "b"], 1, 4, np.random.default_rng(1), ("unknown", "known"))
    views = views_of(_records(rows))
    assert views == [KNOWN, UNKNOWN]
    assert title_of(KNOWN, views) == "Track known"
    assert title_of(KNOWN, [KNOWN, View("test", "known", "follower")]) == "Track known, leaders"


def test_the_price_of_ignorance_in_words():
    rows = [
        *scores({"a": [1.0] * 20, "b": [0.0, 1.0] * 10, "c": [1.0] * 20}, track="known"),
        *scores({"a": [0.0] * 20, "b": [1.0, 0.0] * 10, "c": [1.0] * 20}, track="unknown"),
    ]
    records = _records(rows, mapless={"c"})
    texts = {
        name: price_sentence(prices_of(records, name, "success")[0], METRICS["success"])
        for name in "abc"
    }
    assert texts["a"].startswith("In leaders/static@1: with the map, success changes by +1 [+0.")
    assert texts["a"].endswith("; the map helps.")
    assert texts["b"].endswith("; that may be chance.")
    assert texts["c"].endswith("it uses no map, so a map changes nothing.")
    notes = {r.navigator: r.note for r in records if r.track == IGNORANCE.mark}
    assert notes["c"] == NO_MAP


def test_costs_are_means_over_all_scenarios():
    rows = simulated(["a", "b"], 2, 4, np.random.default_rng(1))
    records = _records(rows)
    found = costs(records, UNKNOWN)
    assert set(found) == {"latency_p50"}
    assert found["latency_p50"]["a"].scenario == ALL
    assert costs(records, KNOWN) == {}


def test_training_and_parameters_of_a_manifest_entry():
    entry = {
        "config": {
            "type": "x", "planner": {"type": "y", "clearance": 0.05}, "hold": None, "name": "z",
        },
        "source": "benchnav 0.2.0", "training": {"decisions": 6515595, "seconds": 2509.2},
        "uses_map": False, "rehearsal": 5,
    }  # fmt: skip
    facts = dict(facts_of(entry))
    assert facts["training"] == "6.52 million decisions of agents in 41.8 min"
    assert facts["map"].startswith("uses no map")
    assert facts["rehearsals"].startswith("5 of each world")
    assert parameters_of(entry["config"]) == [
        ("planner.type", "y"), ("planner.clearance", "0.05"), ("hold", "null"), ("name", "z"),
    ]  # fmt: skip
    assert training_text(None).startswith("none")
    assert training_text({"decisions": 900, "seconds": 40.0}) == "900 decisions of agents in 40.0 s"


def test_curves_of_a_parameter_are_those_of_the_command_line(tmp_path):
    (tmp_path / "two.yaml").write_text(
        "name: two\nscenarios: [trap/u, 'trap/u:mouth=2']\ntracks: [known]\n"
        "navigators: [straight-line]\nseeds: 2\n"
    )
    folder = benchnav.run(tmp_path / "two.yaml", out=tmp_path / "run", quiet=True).folder
    values = stored_values([folder], notify=print)
    (points,) = ParameterCurves([folder], values).panels("trap/u@1:mouth=2", KNOWN)
    assert tuple(points) == curve([folder], "mouth", notify=print)
    assert len({p.x for p in points}) == 2
    assert ParameterCurves([folder], values).panels("trap/u@1", UNKNOWN) == []


def test_a_price_is_a_filled_mark_only_if_its_interval_excludes_0():
    rows = []
    for scenario, unknown in (("a/one@1", [0.0] * 20), ("a/two@1", [0.0, 1.0] * 10)):
        rows += scores({"a": [1.0] * 20}, track="known", scenario=scenario)
        rows += scores({"a": unknown}, track="unknown", scenario=scenario)
    rows += scores({"a": [1.0, 0.0] * 10}, track="known", scenario="a/zero@1")
    rows += scores({"a": [0.0, 1.0] * 10}, track="unknown", scenario="a/zero@1")
    prices = prices_of(_records(rows), "a", "success")
    (trace,) = price_figure(prices, LineStyle("#0072b2", "solid", "circle", ""))["data"]
    assert trace["y"] == ["all scenarios", "a/one@1", "a/two@1", "a/zero@1"]
    assert trace["x"] == pytest.approx([0.5, 1.0, 0.5, 0.0])
    assert trace["marker"]["symbol"] == ["circle"] * 3 + ["circle-open"]


def test_the_default_of_a_parameter_may_be_a_name():
    declared = {
        "robot": {"default": "pioneer-3dx", "description": "its file"},
        "agents": {"default": 8.0, "description": ""},
        "walls": {"default": True, "description": ""},
    }
    facts = dict(scenario_facts({"parameters": declared}, [], "00"))
    assert facts["parameter robot"] == "pioneer-3dx by default (its file)"
    assert facts["parameter agents"] == "8 by default"
    assert facts["parameter walls"] == "True by default"
