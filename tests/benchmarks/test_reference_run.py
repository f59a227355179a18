"""The reference run that docs/leaderboard keeps: a sample is verified, and run again."""

import csv
import json
import re
from pathlib import Path

import pytest

from benchnav.navigation.plugin.trainings import entry_of
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.run import run_suite
from benchnav.store.packs.unpack import opened
from benchnav.store.runs.run_folder import RunFolder
from benchnav.verify.verify import Wanted, verify
from studies.reference_run import DIGITS, METRICS, REPLAYS, SAMPLE, SUITE, digests, unpack_report

KEPT = Path(__file__).parents[2] / "docs" / "leaderboard"
NAME = max(path.stem for path in KEPT.glob("standard-[0-9].json"))  # the newest
AGAIN = ("straight-line", "orca", "visibility+social-force", "ompl-orca", "q-learning")


@pytest.fixture(scope="module")
def said():
    return json.loads((KEPT / f"{NAME}.json").read_text("utf-8"))


def flat(kept):
    """{(scenario, track, navigator): digests of its seeds}."""
    return {
        (scenario, track, who): values.split() if isinstance(values, str) else values
        for scenario, tracks in kept.items()
        for track, navigators in tracks.items()
        for who, values in navigators.items()
    }


def test_it_is_of_the_suite_that_ships(said):
    suite = load_suite(SUITE, Selection(seeds="10"))
    if f"{suite.name}-{suite.version}" > NAME:
        pytest.skip(f"the reference run of {suite.name}@{suite.version} is not made yet")
    assert said["suite"] == f"{suite.name}@{suite.version}"
    jobs = {
        (job.scenario.identity, job.track, job.contestant.label)
        for job in suite.jobs()
        if not job.reason
    }
    assert set(flat(said["digests"])) == jobs
    assert all(len(values) == 10 for values in flat(said["digests"]).values())
    assert said["verified"].startswith("0 findings")
    assert said["sample"].startswith("0 findings")
    assert said["episodes"] == 10 * len(jobs)


def test_its_sample_is_verified_and_of_it(said):
    with opened(KEPT / f"{NAME}-sample.bnrun") as run:
        report = verify(run, Wanted(twin=3), workers=0)
        assert report.findings == []
        assert report.counts["episodes"] > 50
        assert report.counts["twin episodes"] == 3
        assert run.manifest.salt == said["salt"]
        every = flat(said["digests"])
        for job, (first,) in flat(digests(run)).items():
            assert first == every[job][0], job


def test_run_again_it_is_the_same(said, tmp_path):
    """Of navigators whose arithmetic is the same on every processor."""
    wanted = Selection(SAMPLE, navigators=AGAIN, seeds="2", salt=said["salt"])
    run_suite(load_suite(SUITE, wanted), tmp_path / "again", workers=0)
    every, found = flat(said["digests"]), flat(digests(RunFolder.open(tmp_path / "again")))
    assert len(found) > len(SAMPLE) * len(AGAIN)
    for job, values in found.items():
        assert values == every[job][:2], job
        assert {len(value) for value in values} == {DIGITS}


def test_its_report_is_complete(said, tmp_path):
    report = unpack_report(KEPT / f"{NAME}-report.tar.xz", tmp_path)
    assert said["salt"] in (report / "about.html").read_text("utf-8")
    for page in report.rglob("*.html"):
        for link in re.findall(r'(?:href|src)="([^"#:]+)[#"]', page.read_text("utf-8")):
            assert (page.parent / link).resolve().exists(), (page, link)
    assert len(list(report.glob("replays/*.html"))) == REPLAYS


def test_the_page_and_the_records_are_of_it(said):
    page = (KEPT / f"{NAME}.md").read_text("utf-8")
    assert said["pack"]["sha256"] in page
    assert said["suite_hash"] in page
    with (KEPT / f"{NAME}.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["metric"] for row in rows} == set(METRICS)
    assert {row["navigator"] for row in rows} == {
        entry_of(who) for _, _, who in flat(said["digests"])
    }
