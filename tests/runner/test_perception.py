"""Exact and noisy perception as a dimension of a suite, a run and its verification."""

import dataclasses
import json
import shutil

import pyarrow.parquet as pq
import pytest

from benchnav.errors import ConfigError, RunConflictError, ScenarioError, UsageError
from benchnav.metrics.measure import all_metrics
from benchnav.runner.execute.measurement import measured
from benchnav.runner.plan.shard import Shard
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.run import run_suite
from benchnav.store.packs.pack import pack
from benchnav.store.packs.unpack import opened
from benchnav.store.parts.episodes import from_table, to_table
from benchnav.store.parts.part import EPISODES_FILE, RESULTS_FILE
from benchnav.store.runs.merge import merge
from benchnav.store.runs.reading import (
    read_episodes,
    read_episodes_in_every_track,
    read_rehearsals,
    read_results,
)
from benchnav.store.runs.run_folder import RunFolder
from benchnav.verify.verify import Wanted, verify
from tests.runner.verify.forge import Forger

SALT = "5a" * 16
BOTH = "perception: [exact, noisy]\n"
SUITE = """
name: small
tracks: [known, unknown]
seeds: 3
navigators:
  - orca
  - {type: guided-crowd, label: guided, rehearsal: 2, leader: straight-line}
"""


@pytest.fixture(scope="module")
def write(tmp_path_factory, scenario_file, troubled):
    def write(more="", text=SUITE):
        path = tmp_path_factory.mktemp("suite") / "suite.yaml"
        path.write_text(f"{text}scenarios: [{scenario_file}]\n{more}")
        return str(path)

    return write


@pytest.fixture(scope="module")
def both(write):
    return load_suite(write(BOTH), Selection(salt=SALT))


@pytest.fixture(scope="module")
def exact(write):
    return load_suite(write(), Selection(salt=SALT))


@pytest.fixture(scope="module")
def run(both, tmp_path_factory):
    """A run of both perceptions; nobody changes it."""
    path = tmp_path_factory.mktemp("both") / "run"
    run_suite(both, path, workers=0)
    return path


def digests(run, perception=None):
    episodes = (*read_episodes(run), *read_rehearsals(run))
    return {
        str(dataclasses.replace(e.identity, perception="")): e.digest
        for e in episodes
        if perception in (None, e.identity.perception)
    }


def test_every_cell_is_planned_with_each_perception(both, exact):
    jobs = list(both.jobs())
    shown = {(j.contestant.label, j.track, j.also, j.perception) for j in jobs}
    uses_no_map = [("orca", "unknown", ("known",), p) for p in ("exact", "noisy")]
    assert {each for each in shown if each[0] == "orca"} == set(uses_no_map)
    assert [j.perception for j in jobs].count("noisy") == len(jobs) / 2
    keys = {job.key for job in jobs}
    assert len(keys) == len(jobs)
    assert {job.key for job in exact.jobs()} == {j.key for j in jobs if j.perception == "exact"}
    assert all(".noisy." in job.key for job in jobs if job.perception == "noisy")


def test_a_suite_without_the_key_is_described_as_before(exact, both, write):
    assert "perception" not in exact.resolved()
    named = load_suite(write("perception: [exact]\n"))
    assert named.resolved() == exact.resolved()
    assert both.resolved()["perception"] == ["exact", "noisy"]


def test_blocks_may_name_a_part_of_the_perceptions(write):
    blocks = "blocks:\n  - {navigators: [orca]}\n  - {navigators: [guided], perception: [noisy]}\n"
    suite = load_suite(write(BOTH + blocks))
    found = {(job.contestant.label, job.perception) for job in suite.jobs()}
    assert found == {("orca", "exact"), ("orca", "noisy"), ("guided", "noisy")}
    first, second = suite.resolved()["blocks"]
    assert (first["perception"], second["perception"]) == (["exact", "noisy"], ["noisy"])
    plain = load_suite(write("blocks:\n  - {navigators: [orca]}\n"))
    assert set(plain.resolved()["blocks"][0]) == {"scenarios", "tracks", "navigators"}
    added = load_suite(
        write("blocks:\n  - {navigators: [orca]}\n"), Selection(perceptions=("noisy",))
    )
    assert {job.perception for job in added.jobs()} == {"noisy"}


def test_a_selection_replaces_the_perceptions_of_the_suite(write):
    suite = load_suite(write(), Selection(perceptions=("noisy",)))
    assert {job.perception for job in suite.jobs()} == {"noisy"}
    with pytest.raises(UsageError) as caught:
        load_suite(write(), Selection(perceptions=("noise",)))
    assert str(caught.value) == (
        "A perception must be one of exact, noisy. Got 'noise' instead. Did you mean 'noisy'?"
    )
    with pytest.raises(UsageError, match="The perception must be named once each"):
        load_suite(write(), Selection(perceptions=("noisy", "noisy")))


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("perception: [noise]\n", r"suite\.yaml:\d+: perception\[0\].*'noise'.*mean 'noisy'"),
        ("perception: []\n", r"suite\.yaml:\d+: perception must have at least 1 entries"),
        (
            "perceptions: [noisy]\n",
            r":\d+: perceptions is not a known key\. Did you mean 'perception'",
        ),
        ("blocks: [{perception: [noisy]}]\n", r"blocks\[0\]\.perception must be among the suite's"),
        ("perception: [noisy, noisy]\n", r"perception\[1\] must not repeat another"),
    ],
)
def test_a_wrong_key_names_its_place_and_cure(write, lines, message):
    with pytest.raises((ConfigError, ScenarioError, UsageError), match=message):
        load_suite(write(lines))


def test_the_exact_part_equals_an_exact_run_bit_for_bit(run, exact, tmp_path):
    run_suite(exact, tmp_path / "run", workers=0)
    own, alone = RunFolder.open(run).manifest, RunFolder.open(tmp_path / "run").manifest
    assert digests(run, "exact") == digests(tmp_path / "run")
    assert [c for c in own.cells if "perception" not in c] == list(alone.cells)
    assert (own.schema, alone.schema) == (8, 7)
    for path in sorted((tmp_path / "run").glob("parts/*/*.parquet")):
        other = run / path.relative_to(tmp_path / "run")
        assert pq.read_schema(path) == pq.read_schema(other)
        assert "perception" not in pq.read_schema(path).names


def test_noise_changes_what_navigators_do(run):
    exact, noisy = digests(run, "exact"), digests(run, "noisy")
    assert exact.keys() == noisy.keys()
    assert sum(exact[key] != noisy[key] for key in exact) > len(exact) / 2
    some = {e.identity.rehearsal for e in read_rehearsals(run) if e.identity.perception == "noisy"}
    assert some == {1, 2}


def test_results_name_the_perception_in_every_track(run):
    results = read_results(run)
    rows = results.select(["track", "perception", "navigator", "seed", "metric"]).to_pylist()
    found = {(r["track"], r["perception"], r["navigator"]) for r in rows}
    assert found == {
        (t, p, n)
        for t in ("known", "unknown")
        for p in ("exact", "noisy")
        for n in ("orca", "guided")
    }
    assert len({tuple(row.values()) for row in rows}) == len(rows)
    places = [e.identity for e in read_episodes_in_every_track(run)]
    assert len(places) == len(set(places)) == 2 * 2 * 2 * 3


def test_an_interrupted_run_continues(run, both, tmp_path):
    shutil.copytree(run, tmp_path / "run")
    for part in (tmp_path / "run" / "parts").glob("*.noisy.*"):
        shutil.rmtree(part)
    missing = dict(RunFolder.open(tmp_path / "run").missing())
    assert missing
    assert all(".noisy." in key for key in missing)
    run_suite(both, tmp_path / "run", workers=0)
    assert digests(tmp_path / "run") == digests(run)
    assert dict(RunFolder.open(tmp_path / "run").missing()) == {}


def test_a_run_of_exact_perception_is_not_continued_with_noise(exact, both, tmp_path):
    small = dataclasses.replace(exact, seeds=range(1), contestants=exact.contestants[:1])
    run_suite(small, tmp_path / "run", workers=0)
    with pytest.raises(RunConflictError, match="They differ in perception"):
        run_suite(
            dataclasses.replace(small, perceptions=("exact", "noisy")), tmp_path / "run", workers=0
        )


def test_shards_and_packs_hold_both(run, both, tmp_path):
    shards = [tmp_path / "1", tmp_path / "2"]
    for i, shard in enumerate(shards, start=1):
        run_suite(both, shard, workers=0, shard=Shard(i, 2))
    merge(shards, tmp_path / "whole")
    assert digests(tmp_path / "whole", "noisy") == digests(run, "noisy")
    pack(RunFolder.open(run), tmp_path / "run.bnrun")
    with opened(tmp_path / "run.bnrun") as folder:
        assert digests(folder.path) == digests(run)


def test_an_isolated_navigator_senses_the_same_noise(run, both, tmp_path):
    few = dataclasses.replace(both, seeds=range(1), contestants=both.contestants[:1])
    (orca,) = few.contestants
    apart = dataclasses.replace(few, contestants=(dataclasses.replace(orca, mode="isolated"),))
    found = []
    for suite, out in ((few, "here"), (apart, "apart")):
        run_suite(suite, tmp_path / out, workers=1)
        found.append([e.digest for e in read_episodes(tmp_path / out)])
    assert found[0] == found[1]
    assert len(set(found[0])) == 2


def checked(run, **wanted):
    with opened(run) as folder:
        report = verify(folder, Wanted(**{"twin": 0, **wanted}), workers=0)
    return {finding.kind for finding in report.findings}, report


def test_a_genuine_run_is_verified_and_repeated(run):
    kinds, report = checked(run, rerun=True)
    assert kinds == set()
    assert report.notes == {}
    assert report.counts["rerun"] == 2 * 2 * 3  # no navigator uses a map


def test_commands_of_exact_perception_are_not_those_of_noisy(run, tmp_path):
    """Only running the navigator again finds it: the commands are possible."""
    shutil.copytree(run, tmp_path / "run")
    forger = Forger(tmp_path / "run")
    stems = forger.stems("orca")
    exact = next(stem for stem in stems if ".noisy." not in stem)
    noisy = next(stem for stem in stems if ".noisy." in stem)
    own = list(from_table(pq.read_table(noisy + EPISODES_FILE)))
    better = [
        dataclasses.replace(e, identity=own[i].identity)
        for i, e in enumerate(from_table(pq.read_table(exact + EPISODES_FILE)))
    ]
    pq.write_table(to_table(better), noisy + EPISODES_FILE)
    pq.write_table(measured(better, all_metrics()), noisy + RESULTS_FILE)
    forger.seal(noisy)
    assert checked(tmp_path / "run")[0] == set()
    kinds, report = checked(tmp_path / "run", rerun=True)
    assert kinds == {"rerun"}
    assert report.findings[0].where.startswith("tiny/crossing@1, unknown, noisy, orca, seed ")


def test_a_row_of_the_other_perception_is_refused(run, tmp_path):
    shutil.copytree(run, tmp_path / "run")
    forger = Forger(tmp_path / "run")
    (stem,) = (stem for stem in forger.stems("orca") if ".noisy." in stem)
    forger.column(stem, RESULTS_FILE, "perception", lambda _: "exact")
    kinds, report = checked(tmp_path / "run")
    assert kinds == {"identity"}
    assert "must have perception 'noisy' in row 0" in report.findings[0].what


def test_a_manifest_that_calls_a_cell_exact_is_found(run, tmp_path):
    shutil.copytree(run, tmp_path / "run")
    path = tmp_path / "run" / "manifest.json"
    fields = json.loads(path.read_text())
    cell = next(c for c in fields["cells"] if c.get("perception") == "noisy")
    cell["perception"] = "neither"
    text = {k: v for k, v in fields.items() if k != "sha256"}
    path.write_text(json.dumps(text))
    with pytest.raises(Exception, match=r"manifest.json is damaged"):
        RunFolder.open(tmp_path / "run")
