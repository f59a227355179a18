"""Undisturbed worlds: run once for a seed, compared with by all navigators, and verified."""

import dataclasses
import shutil

import numpy as np
import pyarrow.parquet as pq
import pytest

import benchnav
from benchnav.errors import ScenarioError
from benchnav.metrics.measure import all_metrics
from benchnav.runner.execute.measurement import measure_again
from benchnav.runner.plan.limits import Limits
from benchnav.runner.plan.shard import Shard
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.ray.ray_executor import undisturbed_files
from benchnav.runner.ray.ray_worker import RayWorker
from benchnav.runner.run import Summary, _tasks, run_suite
from benchnav.store.parts.episodes import from_table
from benchnav.store.parts.part import EPISODES_FILE, RESULTS_FILE
from benchnav.store.runs.manifest import load_manifest
from benchnav.store.runs.merge import merge
from benchnav.store.runs.reading import read_episodes, read_results, results_of
from benchnav.store.runs.run_folder import RunFolder
from benchnav.verify.resimulation import resimulate
from tests.runner.verify.forge import Forger, flipped

SALT = "5a" * 16
METRICS = ("people_delay", "people_detour")
SCENARIO = """
name: tiny/lane
title: A robot meets people
bounds: [-9, -9, 9, 9]
teams:
  - name: robots
    radius: 0.4
    max_speed: 1.2
    start: {{type: points, points: [[-5, {y}]]}}
    goal: {{type: points, points: [[5, {y}]]}}
  - name: people
    count: 4
    radius: 0.23
    max_speed: 2.5
    preferred_speed: {{uniform: [1.0, 1.5]}}
    start: {{type: region, region: {{type: rectangle, bounds: [1, -1, 5, 1]}}, separation: 0.2}}
    goal: {{type: shifted, by: [-9, 0]}}
    driver: {{type: none+social-groups, controller: {{stop_every: 3, stop_for: 1}}}}
    ignores: {ignored}
  - name: hurried
    count: 2
    radius: 0.23
    max_speed: 2
    start: {{type: region, region: {{type: rectangle, bounds: [1, -3, 5, -2]}}, separation: 0.2}}
    goal: {{type: shifted, by: [-9, 0]}}
    driver: none+social-force
    ignores: {ignored}
clock: {{dt: 0.2, substeps: 1, horizon: 5}}
rules: {{goal_tolerance: 0.5, contact: slide, on_arrival: vanish}}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lane")
    (folder / "near.yaml").write_text(SCENARIO.format(y=0.0, ignored="[]"))
    (folder / "far.yaml").write_text(SCENARIO.format(y=8.0, ignored="[robots]"))
    return folder


def suite_of(folder, seeds="3", name="near"):
    wanted = Selection(navigators=("orca", "straight-line"), seeds=seeds, salt=SALT)
    return load_suite(str(folder / f"{name}.yaml"), wanted)


@pytest.fixture(scope="module")
def genuine(folder):
    run_suite(suite_of(folder), folder / "genuine", workers=0)
    return folder / "genuine"


@pytest.fixture
def forger(genuine, tmp_path):
    shutil.copytree(genuine, tmp_path / "run")
    return Forger(tmp_path / "run")


def facts(run):
    folder = RunFolder.open(run)
    episodes = {str(e.identity): e.digest for part in folder.parts() for e in part.episodes()}
    verifiable = {metric.name for metric in all_metrics() if metric.verifiable}
    rows = results_of(folder, undisturbed=True).to_pylist()
    return episodes, sorted(str(row) for row in rows if row["metric"] in verifiable)


def disturbances(run):
    rows = read_results(run).to_pylist()
    return {
        (row["navigator"], row["seed"], row["metric"]): row["value"]
        for row in rows
        if row["metric"] in METRICS
    }


def test_it_runs_once_for_each_seed(folder, genuine):
    cells = load_manifest(genuine).cells
    assert [cell["navigator"] for cell in cells] == ["orca", "straight-line", "undisturbed"]
    found = RunFolder.open(genuine)
    (part,) = found.parts_in(cells[-1])
    undisturbed = list(part.episodes())
    assert [e.identity.seed for e in undisturbed] == [0, 1, 2]
    assert all(len(e.world.agents) == 6 for e in undisturbed)
    again = run_suite(suite_of(folder), genuine, workers=0)
    assert again.found == again.total == 9


def test_people_walk_alike_beside_a_robot_that_they_do_not_notice(folder):
    """Groups, stops and all: each driver draws the same random numbers as beside the robot."""
    run = folder / "far"
    run_suite(suite_of(folder, "2", "far"), run, workers=0)
    for episode in read_episodes(run):
        other = episode.undisturbed()
        steps = 1 + min(len(episode.requested), len(other.requested))
        np.testing.assert_array_equal(episode.position[:steps, 1:], other.position[:steps])
        assert np.diff(other.position, axis=0).any()
    assert set(disturbances(run).values()) == {0.0}


def test_a_robot_disturbs_people_and_the_values_are_those_of_the_stored_episodes(genuine):
    found = disturbances(genuine)
    assert len(found) == 2 * 3 * 2
    assert all(value != 0.0 for value in found.values())
    again = measure_again(genuine, [m for m in all_metrics() if m.name in METRICS]).to_pylist()
    assert {(r["navigator"], r["seed"], r["metric"]): r["value"] for r in again} == found


def test_an_episode_in_memory_has_the_same_undisturbed_world(folder, genuine):
    world = benchnav.load_scenario(folder / "near.yaml").world(seed=1)
    episode = benchnav.simulate(world, "orca", salt=SALT)
    stored = benchnav.open_run(genuine).episodes("undisturbed", seed=1)[0]
    assert episode.undisturbed.record.digest == stored.record.digest
    expected = disturbances(genuine)
    for name in METRICS:
        assert episode.metric(name) == expected["orca", 1, name]
    assert stored.undisturbed is None


def test_it_is_no_entry(genuine):
    run = benchnav.open_run(genuine)
    assert run.navigators == ("orca", "straight-line")
    assert len(run.episodes()) == 6
    assert {e.navigator for e in run.episodes()} == set(run.navigators)
    assert "undisturbed" not in str(run.leaderboard(metrics="all"))
    assert "undisturbed" not in set(read_results(genuine)["navigator"].to_pylist())
    assert len(repr(run.episodes("undisturbed"))) > 0


def test_it_is_verified_and_run_again(genuine, findings):
    _, report = findings(genuine, twin=2, rerun=True)
    assert report.findings == []
    assert (report.counts["episodes"], report.counts["rerun"]) == (9, 9)
    assert not any("undisturbed" in line for line in report.sources)


def test_a_share_has_the_undisturbed_episodes_of_its_seeds(folder, genuine, tmp_path, monkeypatch):
    monkeypatch.setattr("benchnav.runner.plan.task.CHUNK", 1)
    shares = [tmp_path / "one", tmp_path / "two"]
    for index, share in enumerate(shares, 1):
        summary = run_suite(suite_of(folder), share, workers=0, shard=Shard(index, 2))
        assert summary.stored == summary.total in (3, 6)
        assert all(np.isfinite(value) for value in disturbances(share).values())
    assert merge(shares, tmp_path / "whole").copied == 9
    assert facts(tmp_path / "whole") == facts(genuine)


def test_more_seeds_are_added(folder, genuine, tmp_path):
    run_suite(suite_of(folder, "1"), tmp_path / "run", workers=0)
    run_suite(suite_of(folder, "3"), tmp_path / "run", workers=0)
    assert facts(tmp_path / "run") == facts(genuine)


def test_another_machine_receives_it(folder, genuine):
    found = RunFolder.open(genuine)
    suite = suite_of(folder)
    jobs = list(suite.jobs())
    every = {job.key: set(suite.seeds) for job in jobs}
    monkey = dataclasses.replace(found, path=folder / "elsewhere")
    tasks = _tasks(suite, monkey, jobs, every, Summary(), None)
    task = next(t for t in tasks if t.job.contestant.label == "orca")
    other = found.cell(found.undisturbed_key(task.job.scenario.identity))
    files = undisturbed_files(dataclasses.replace(task, undisturbed=other))
    assert {name.partition(".")[0] for name in files} == {"000000-000003"}
    worker = RayWorker(Limits(timeout=60.0), [])
    try:
        (delivery,) = worker.work(task, {}, files)
    finally:
        worker.close()
    assert delivery.task.undisturbed == task.undisturbed
    path = folder / "results.parquet"
    path.write_bytes(delivery.files[RESULTS_FILE])
    rows = pq.read_table(path).to_pylist()
    expected = disturbances(genuine)
    got = {row["seed"]: row["value"] for row in rows if row["metric"] == "people_delay"}
    assert got == {seed: expected["orca", seed, "people_delay"] for seed in range(3)}


def test_states_of_undisturbed_people_cannot_be_forged(forger, findings):
    (stem,) = forger.stems("undisturbed")

    def change(episode):
        position = episode.position.copy()
        position[-1, 0, 0] = flipped(float(position[-1, 0, 0]))
        return dataclasses.replace(episode, position=position)

    forger.episode(stem, change)
    kinds, report = findings(forger.run)
    assert "state" in kinds
    assert any("undisturbed" in finding.where for finding in report.findings)


def test_other_ways_of_undisturbed_people_do_not_fit_the_values(forger, findings):
    """A false episode that obeys the simulator: the values of all navigators disagree with it."""
    (stem,) = forger.stems("undisturbed")

    def change(episode):
        waits = dataclasses.replace(episode, requested=0.5 * episode.requested)
        return resimulate([(episode.world, waits)])[0].episode

    forger.episode(stem, change)
    _, report = findings(forger.run)
    wrong = {f.where for f in report.findings if f.kind == "metric"}
    assert any("orca" in where for where in wrong)
    assert any("straight-line" in where for where in wrong)
    assert "rerun" in findings(forger.run, rerun=True)[0]


@pytest.mark.parametrize("metric", METRICS)
def test_values_cannot_be_forged(forger, findings, metric):
    (stem,) = forger.stems("orca")
    names = pq.read_table(stem + RESULTS_FILE)["metric"].to_pylist()
    forger.column(stem, RESULTS_FILE, "value", lambda value: value + 0.01, names.index(metric))
    assert findings(forger.run)[0] == {"metric"}


def test_an_undisturbed_world_with_the_robot_is_found(forger, findings):
    (robot,), (stem,) = forger.stems("orca"), forger.stems("undisturbed")
    first = next(iter(from_table(pq.read_table(robot + EPISODES_FILE))))
    forger.episode(stem, lambda e: dataclasses.replace(first, identity=e.identity))
    assert "world" in findings(forger.run)[0]


def test_missing_undisturbed_episodes_are_found(forger, findings):
    for path in forger.run.glob("parts/*undisturbed*/*"):
        path.unlink()
    kinds, report = findings(forger.run)
    assert kinds == {"coverage", "metric"}, report.findings


def test_a_manifest_that_does_not_say_that_it_has_them_is_found(forger, findings):
    forger.manifest(lambda manifest: manifest["suite"].pop("undisturbed"))
    assert findings(forger.run)[0]


@pytest.mark.parametrize("value", [True, False])
def test_a_manifest_that_names_none_without_reason_is_found(folder, findings, tmp_path, value):
    text = (folder / "near.yaml").read_text()
    end = "clock: {dt: 0.2, substeps: 1, horizon: 1}\n"
    (tmp_path / "alone.yaml").write_text(text.split("  - name: people")[0] + end)
    suite = load_suite(str(tmp_path / "alone.yaml"), Selection(navigators=("orca",), seeds="1"))
    run_suite(suite, tmp_path / "run", workers=0)
    assert findings(tmp_path / "run")[1].findings == []
    forger = Forger(tmp_path / "run")
    forger.manifest(lambda manifest: manifest["suite"].update(undisturbed=value))
    assert findings(forger.run)[0] == {"manifest"}


def test_a_suite_says_so_and_only_where_people_react(folder, scenario_file, tmp_path):
    text = "name: mine\nscenarios: [{0}]\nnavigators: [orca]\nseeds: 1\n"
    path = tmp_path / "suite.yaml"
    for more, scenario, expected in [
        ("", folder / "near.yaml", False),
        ("undisturbed: true\n", folder / "near.yaml", True),
        ("undisturbed: true\n", folder / "alone.yaml", False),
    ]:
        (folder / "alone.yaml").write_text(
            (folder / "near.yaml").read_text().split("  - name: people")[0]
            + "clock: {dt: 0.2, substeps: 1, horizon: 5}\n"
        )
        path.write_text(text.format(scenario) + more)
        suite = load_suite(str(path))
        assert any(job.undisturbed for job in suite.jobs()) == expected
        assert ("undisturbed" in suite.resolved()) == expected


def test_its_label_is_reserved(folder):
    spec = {"type": "orca", "label": "undisturbed"}
    with pytest.raises(ScenarioError, match=r"label 'undisturbed' is reserved .* another label"):
        load_suite(str(folder / "near.yaml"), Selection(navigators=(spec,)))
