"""A report of a run with both perceptions."""

import json
import re

import pytest

import benchnav
from benchnav.report.page import navigator_path, replay_path

SUITE = {
    "name": "both", "scenarios": ["trap/u"], "navigators": ["orca", "straight-line"],
    "tracks": ["known", "unknown"], "perception": ["exact", "noisy"], "seeds": 2,
}  # fmt: skip


@pytest.fixture(scope="module")
def site(report, tmp_path_factory):
    """The folder of the report; ``report`` skips where the extra is missing."""
    folder = tmp_path_factory.mktemp("both")
    run = benchnav.run(SUITE, out=folder / "run", quiet=True)
    return run.report(folder / "site", quiet=True).parent


def test_the_leaderboard_has_a_column_and_a_filter(site):
    text = (site / "index.html").read_text()
    assert '<th data-name="perception" class="collapse">perception</th>' in text
    assert '<select name="perception">' in text
    assert len(re.findall('data-perception="noisy"', text)) == len(
        re.findall('data-perception="exact"', text)
    )
    assert "exact and noisy perception" in text


def test_failures_are_listed_with_the_command_that_plays_them(site):
    text = (site / "failures.html").read_text()
    found = {str(path.relative_to(site)) for path in site.glob("replays/*")}
    for perception in ("exact", "noisy"):
        path = replay_path("straight-line", "trap/u@1", "known", 0, perception)
        assert str(path) in found
        assert str(path) in text


def test_a_navigator_has_a_price_of_noise(site):
    text = (site / navigator_path("orca")).read_text()
    assert "<h2>Price of noise</h2>" in text
    assert "exact − noisy" in text
    assert "In trap/u@1, track known" in text
    assert "Track known, noisy perception" in text


def test_scenarios_show_each_condition(site):
    (page,) = site.glob("scenarios/trap*.html")
    text = page.read_text()
    for heading in ("Track known", "Track known, noisy perception", "Track unknown"):
        assert f">{heading}</h2>" in text


def test_two_navigators_are_compared_within_a_condition(site):
    text = (site / "comparison.html").read_text()
    shared = json.loads(re.search(r'id="shared">(.*?)</script>', text, re.DOTALL)[1])
    conditions = ["known", "known, noisy", "unknown", "unknown, noisy"]
    assert shared["tracks"] == conditions
    assert {place[1] for place in shared["places"]} == set(conditions)


def test_a_report_of_exact_perception_says_nothing_about_it(report):
    for path in report.rglob("*.html"):
        if path.parent.name != "replays" and path.name != "about.html":  # the command that ran it
            assert "perception" not in path.read_text().lower(), path
