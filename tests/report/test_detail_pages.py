"""The pages of scenarios and navigators, and the comparison: numbers, and names as text."""

import json
import re
from html import escape

import pytest

import benchnav
from benchnav.drawing.palette import NAVIGATORS, TEAMS
from benchnav.leaderboard.from_runs import stored_values
from benchnav.leaderboard.rendering.cell import column
from benchnav.report.page import COMPARISON, SCENARIOS, navigator_path, scenario_path
from benchnav.report.pages import comparison_page, navigator_page, scenario_page
from benchnav.report.report_data import read_runs
from tests.report.conftest import EVIL, ODD

SCRIPTS = re.compile(
    r'<script type="application/json"(?: id="([\w-]+)")?>(.*?)</script>', re.DOTALL
)


@pytest.fixture(scope="module")
def data(run):
    pytest.importorskip("plotly")
    pytest.importorskip("jinja2")
    return read_runs([run.folder], stored_values([run.folder], notify=print))


@pytest.fixture(scope="module")
def bodies(data):
    modules = (scenario_page, navigator_page, comparison_page)
    return {page.path: str(page.body) for module in modules for page in module.pages(data)}


def figures(text):
    return [json.loads(found) for name, found in SCRIPTS.findall(text) if not name]


def traces(text, kind):
    return [t for figure in figures(text) for t in figure["data"] if t["type"] == kind]


def test_a_scenario_page_shows_its_worlds_results_and_failures(bodies, run):
    text = bodies[scenario_path("trap/u@1")]
    assert text.count("<svg") == 2  # seeds
    assert text.count("<h2 id=") == 2  # tracks
    assert len(figures(text)) >= 6
    success = [r for r in run.leaderboard().records if r.metric == "success"]
    shown = [r for r in success if (r.scenario, r.track) == ("trap/u@1", "known")]
    for each in column(shown, decided=False):
        assert escape(each.text) in text
    (record,) = (r for r in shown if r.navigator == "visibility+orca")
    (dot,) = (t for t in traces(text, "scatter") if t["y"] == ["visibility+orca"])
    assert dot["x"] == [pytest.approx(record.value)]


def test_outcomes_add_up_to_one_and_success_is_that_of_the_leaderboard(bodies, run):
    bars = [t for t in traces(bodies[scenario_path("odd@1")], "bar") if max(t["x"]) <= 1.0]
    rows = {}
    for bar in bars:
        for name, share in zip(bar["y"], bar["x"], strict=True):
            rows[name] = rows.get(name, 0.0) + share
    tracks = {name: total for name, total in rows.items() if name == "straight-line"}
    assert tracks == {"straight-line": pytest.approx(2.0)}  # one in each of two tracks
    won = [t["x"][t["y"].index("straight-line")] for t in bars if t["name"] == "success"]
    records = run.leaderboard().records
    expected = [
        r.value for r in records
        if (r.navigator, r.scenario, r.metric) == ("straight-line", "odd@1", "success")
        and r.track in ("known", "unknown")
    ]  # fmt: skip
    assert won == pytest.approx(expected)


def test_obstacles_that_were_hit_are_named_and_numbered(bodies):
    text = bodies[scenario_path("odd@1")]
    assert any("static obstacle 1" in t["y"] for t in traces(text, "bar"))
    assert ">1</text>" in text
    assert "<title>straight-line: static obstacle 1, " in text


def test_a_picture_has_the_colours_of_navigators_only_in_its_crosses(bodies):
    for path in (SCENARIOS, scenario_path("trap/u@1"), scenario_path("odd@1")):
        pictures = re.findall(r"<svg.*?</svg>", bodies[path], re.DOTALL)
        assert pictures
        for picture in pictures:
            bare = re.sub(r"<path[^>]*><title>.*?</path>", "", picture)
            assert not {color for color in (*NAVIGATORS, *TEAMS) if color in bare}


def test_the_table_of_a_scenario_links_its_navigators(bodies):
    text = SCRIPTS.sub("", bodies[scenario_path("trap/u@1")])
    name = navigator_path("straight-line").name
    assert f'href="../navigators/{name}">straight-line</a>' in text


def test_a_navigator_page_has_its_profile_price_cost_and_configuration(bodies):
    text = bodies[navigator_path("straight-line")]
    for heading in (
        "Profile over families",
        "Failures by cause",
        "Price of ignorance",
        "Cost in time",
    ):
        assert heading in text
    assert "it uses no map, so a map changes nothing." in text
    profile = next(t for t in traces(text, "scatter") if t["name"] == "straight-line")
    assert profile["y"] == ["trap", "odd"]
    assert "planning_time" in text
    assert "needs a map" in bodies[navigator_path("visibility+orca")]


def test_names_are_text_everywhere(bodies):
    for path, text in bodies.items():
        outside = SCRIPTS.sub("", text)
        assert "<img" not in outside, path
        assert "<script>problems" not in text, path
        for found in figures(text):
            names = [str(t.get("name")) for t in found["data"]]
            assert not [name for name in names if "<img" in name], path


def test_the_comparison_has_the_numbers_of_compare(bodies, run):
    scripts = {name: json.loads(text) for name, text in SCRIPTS.findall(bodies[COMPARISON])}
    shared = scripts.pop("shared")
    labels = [navigator["name"] for navigator in shared["navigators"]]
    assert sorted(labels) == sorted(run.navigators)
    assert len(scripts) == 3
    for key, pair in scripts.items():
        first, second = (labels[int(k)] for k in key.split("-")[1:])
        expected = run.compare(first, second).records
        assert len(pair["rows"]) == len(expected)
        for (metric, place, worlds, *numbers, verdict), c in zip(
            pair["rows"], expected, strict=True
        ):
            scenario, track, role, split = shared["places"][place]
            assert shared["metrics"][metric]["name"] == c.metric
            assert (scenario or "all", track, role, split) == (c.scenario, c.track, c.role, c.split)
            assert (worlds, shared["verdicts"][verdict]) == (c.worlds, c.verdict)
            wanted = (c.difference, c.low, c.high, c.adjusted)
            got = [float("nan") if x is None else x for x in numbers]
            assert got == pytest.approx(wanted, rel=1e-4, nan_ok=True)


def test_results_of_two_horizons_stand_apart(run, tmp_path):
    pytest.importorskip("plotly")
    pytest.importorskip("jinja2")
    (tmp_path / "odd.yaml").write_text(ODD.replace("horizon: 12", "horizon: 9"))
    other = benchnav.run(
        tmp_path / "odd.yaml", navigators=["straight-line"], tracks=["known"], seeds=2,
        out=tmp_path / "run", quiet=True,
    )  # fmt: skip
    folders = [run.folder, other.folder]
    data = read_runs(folders, stored_values(folders, notify=print))
    (text,) = (
        str(page.body) for page in scenario_page.pages(data) if page.path == scenario_path("odd@1")
    )
    headings = re.findall(r'<h2 id="results-.*?>(.*?)</h2>', text)
    assert len(headings) == 3
    assert [h for h in headings if "horizon 9 s" in h] == [headings[2]]
    assert all("horizon 12 s" in h for h in headings[:2])


def test_labels_that_try_to_be_markup_stay_in_their_script(bodies):
    text = bodies[COMPARISON]
    assert EVIL not in text
    assert "\\u003cimg" in text
