"""The pages of a report: they are complete, their links lead somewhere, and names are text."""

import re
from html.parser import HTMLParser
from pathlib import Path, PurePosixPath
from urllib.parse import unquote, urlsplit

import yaml

from benchnav.report import citation
from benchnav.report.page import (
    ABOUT,
    COMPARISON,
    FAILURES,
    LEADERBOARD,
    NAVIGATORS,
    SCENARIOS,
    navigator_path,
    replay_path,
    scenario_path,
)
from tests.report.conftest import EVIL


class Links(HTMLParser):
    """Collects what a page links, and the elements in it."""

    def __init__(self, text):
        super().__init__()
        self.links, self.tags, self.attributes = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += [name for name, _ in attrs]
        self.links += [value for name, value in attrs if name in ("href", "src")]


def pages(report):
    return sorted(report.rglob("*.html"))


def rows(text):
    """The cells of each row of the first table body, without markup."""
    body = re.search(r"<tbody>(.*?)</tbody>", text, re.DOTALL)[1]
    return [
        [re.sub(r"<[^>]*>", "", cell).strip() for cell in re.findall(r"<td[^>]*>(.*?)</td>", row)]
        for row in re.findall(r"<tr.*?</tr>", body, re.DOTALL)
    ]


def test_there_is_a_page_for_everything(report, run):
    top = {str(path) for path in (LEADERBOARD, SCENARIOS, NAVIGATORS, COMPARISON, FAILURES, ABOUT)}
    each = {str(scenario_path(name)) for name in run.scenarios}
    each |= {str(navigator_path(name)) for name in run.navigators}
    found = {str(PurePosixPath(path.relative_to(report))) for path in pages(report)}
    assert top | each <= found
    assert str(replay_path("straight-line", "trap/u@1", "known", 0)) in found


def test_all_links_are_relative_and_lead_somewhere(report):
    for page in pages(report):
        for link in Links(page.read_text(encoding="utf-8")).links:
            parts = urlsplit(link)
            assert not parts.scheme, (page, link)
            assert not parts.netloc, (page, link)
            assert not parts.path or (page.parent / unquote(parts.path)).is_file(), (page, link)


def test_names_from_runs_are_text(report):
    for page in pages(report):
        found = Links(page.read_text(encoding="utf-8"))
        assert "img" not in found.tags, page
        assert not [name for name in found.attributes if name.startswith("on")], page
    assert EVIL.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;") in (
        report / LEADERBOARD
    ).read_text(encoding="utf-8")


def test_the_leaderboard_has_a_row_for_each_navigator_scenario_and_track(report, run):
    text = (report / LEADERBOARD).read_text(encoding="utf-8")
    scenarios, tracks = len(run.scenarios), len(run.tracks)
    assert len(rows(text)) == 3 * tracks * (scenarios + 1) - 1  # an n/a row has no mean


def test_a_missing_result_has_its_reason(report):
    text = (report / LEADERBOARD).read_text(encoding="utf-8")
    missing = [row for row in rows(text) if "n/a" in row[1]]
    assert {(row[0], row[3]) for row in missing} == {("visibility+orca", "unknown")}
    assert {row[1] for row in missing} == {"n/a (needs a map)"}


def test_numbers_are_those_of_the_leaderboard(report, run):
    (record,) = (
        r
        for r in run.leaderboard().records
        if (r.navigator, r.scenario, r.track, r.metric)
        == ("straight-line", "trap/u@1", "known", "success")
    )
    text = (report / LEADERBOARD).read_text(encoding="utf-8")
    row = next(r for r in rows(text) if r[0] == "straight-line" and r[2:4] == ["trap/u@1", "known"])
    assert row[5].startswith(f"{record.value:.0f}")


def test_the_leaderboard_names_the_best_and_a_command_for_more_worlds(report, run):
    text = (report / LEADERBOARD).read_text(encoding="utf-8")
    assert "Track known: no navigator is separated from the others in success by these 4" in text
    assert f"benchnav run small --out {run.path} --seeds 8" in text


def test_a_failure_without_a_replay_has_its_command(run, tmp_path):
    folder = run.report(tmp_path / "report", replays=1, quiet=True).parent
    assert len(list((folder / "replays").iterdir())) == 1
    text = (folder / FAILURES).read_text(encoding="utf-8")
    command = f"benchnav replay {run.path} --navigator straight-line --scenario trap/u@1"
    assert f"{command} --track" in text
    assert "have no replay" in text


def test_replays_share_their_program(report):
    for page in (report / "replays").iterdir():
        text = page.read_text(encoding="utf-8")
        assert '<script src="../assets/replay.js">' in text
        assert "<style>" not in text


def test_a_page_says_where_the_numbers_come_from(report, run):
    text = (report / ABOUT).read_text(encoding="utf-8")
    manifest = run.folder.manifest
    for fact in (manifest.salt, manifest.suite_hash, manifest.created, manifest.platform):
        assert fact in text
    assert f"benchnav verify {run.path}" in text
    entries = re.findall(r'<pre class="copied">(.*?)</pre>', text, re.DOTALL)
    year = entries[0].partition("year    = {")[2][:4]
    assert entries == [citation.software(year), citation.PAPER]
    assert "not verified on the machine" in text


def test_citations_agree_with_the_citation_file():
    root = Path(citation.__file__).parents[2]
    cff = yaml.safe_load((root / "CITATION.cff").read_text("utf-8"))
    software, paper = citation.software("2026"), " ".join(citation.PAPER.split())
    assert cff["title"] == citation.TITLE
    assert cff["version"] in software
    (reference,) = cff["references"]
    assert reference["title"] in paper
    names = (f"{a['family-names']}, {a['given-names']}" for a in reference["authors"])
    assert " and ".join(names) in paper
    assert reference["journal"] in paper
    assert reference["url"] in paper


def test_a_verified_run_is_marked(report, run, tmp_path):
    assert run.verify(twin=0, workers=0, quiet=True).verified
    folder = run.report(tmp_path / "report", replays=0, quiet=True).parent
    assert "Verified on the machine that made the report" in (folder / ABOUT).read_text("utf-8")
    assert 'class="chip"' in (folder / LEADERBOARD).read_text("utf-8")
