"""A suite is run whole, however often it is interrupted, by however many workers."""

import os
import re
import signal
import subprocess
import sys
import time

import pytest

from benchnav.errors import (
    RunConflictError,
    UnsolvableError,
    UsageError,
)
from benchnav.metrics.measure import all_metrics
from benchnav.plugins import METRICS, register_navigator
from benchnav.processes import fork_server
from benchnav.runner.execute.measurement import measure_again
from benchnav.runner.execute.progress import Progress
from benchnav.runner.plan import task as task_module
from benchnav.runner.plan.shard import Shard
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.plan.task import chunks, joined_chunks
from benchnav.runner.run import run_suite
from benchnav.store.parts.part import SEAL
from benchnav.store.runs.manifest import load_manifest
from benchnav.store.runs.reading import read_episodes, read_results
from benchnav.store.runs.run_folder import RunFolder


@pytest.fixture
def suite_file(tmp_path, scenario_file, troubled):
    path = tmp_path / "suite.yaml"
    path.write_text(
        f"name: small\nscenarios: [{scenario_file}]\n"
        "navigators: [orca, {type: 'troubled_navigators:Walk', label: walk}]\nseeds: 6\n"
    )
    return path


@pytest.fixture
def small_tasks(monkeypatch):
    monkeypatch.setattr(task_module, "CHUNK", 2)
    monkeypatch.setattr(task_module, "LARGEST", 1)


def digests(run):
    return {(e.identity.navigator, e.identity.seed): e.digest for e in read_episodes(run)}


TIMINGS = ("decision_time", "planning_time", "latency", "peak_memory")


def table(run):
    """The results, timings aside."""
    rows = read_results(run).to_pylist()
    return {
        (r["navigator"], r["seed"], r["role"], r["metric"]): repr(r["value"])
        for r in rows
        if not r["metric"].startswith(TIMINGS)
    }


SALT = "5a" * 16  # for runs that are compared


class Counting(Progress):
    def __init__(self):
        self.done = 0

    def begin(self, total, stored):
        self.total, self.done = total, stored

    def advance(self, episodes):
        self.done += episodes


def test_no_number_of_workers_and_no_chunk_size_changes_a_bit(suite_file, tmp_path, monkeypatch):
    suite = load_suite(str(suite_file), Selection(salt=SALT))
    told = Counting()
    summary = run_suite(suite, tmp_path / "here", workers=0, progress=told)
    assert (summary.total, summary.stored, summary.found) == (12, 12, 0)
    assert (told.total, told.done) == (12, 12)
    monkeypatch.setattr(task_module, "CHUNK", 2)
    told = Counting()
    run_suite(suite, tmp_path / "there", workers=2, progress=told)
    assert told.done == 12
    assert digests(tmp_path / "there") == digests(tmp_path / "here")
    assert table(tmp_path / "there") == table(tmp_path / "here")


def test_what_is_missing_is_run_and_nothing_else(suite_file, tmp_path, small_tasks):
    suite, out = load_suite(str(suite_file)), tmp_path / "run"
    run_suite(suite, out, workers=0)
    whole = digests(out)
    gone, kept = sorted(out.glob(f"parts/*/*{SEAL}"))[::3], {}
    for seal in gone:
        seal.unlink()
    kept = {seal: seal.stat().st_mtime_ns for seal in out.glob(f"parts/*/*{SEAL}")}
    summary = run_suite(suite, out, workers=0)
    assert summary.stored - summary.found == 2 * len(gone)
    assert digests(out) == whole
    assert all(seal.stat().st_mtime_ns == when for seal, when in kept.items())
    again = run_suite(suite, out, workers=2)
    assert again.found == again.stored == 12


def test_each_run_has_a_salt_of_its_own_and_can_be_repeated(suite_file, tmp_path):
    suite = load_suite(str(suite_file))
    first, other, again = (tmp_path / name for name in ("first", "other", "again"))
    run_suite(suite, first, workers=0)
    run_suite(suite, other, workers=0)
    salt = load_manifest(first).salt
    assert len(bytes.fromhex(salt)) == 16
    assert salt != load_manifest(other).salt
    walked, differently = digests(first), digests(other)
    assert all(walked["walk", s] != differently["walk", s] for s in range(6))
    run_suite(load_suite(str(suite_file), Selection(salt=salt.upper())), again, workers=0)
    assert digests(again) == walked


def test_one_label_for_two_configurations_is_told_apart(suite_file, tmp_path):
    plain = Selection(navigators=("orca",), seeds="1")
    short = Selection(navigators=("{type: orca, label: orca, time_horizon: 0.05}",), seeds="1")
    hashes = []
    for k, chosen in enumerate((plain, short, plain)):
        run_suite(load_suite(str(suite_file), chosen), tmp_path / f"{k}", workers=0)
        rows = read_results(tmp_path / f"{k}")
        assert set(rows["navigator"].to_pylist()) == {"orca"}
        (found,) = set(rows["navigator_hash"].to_pylist())
        again = measure_again(tmp_path / f"{k}", all_metrics())
        assert set(again["navigator_hash"].to_pylist()) == {found}
        hashes.append(found)
    assert hashes[0] == hashes[2] != hashes[1]
    assert all(len(found) == 16 for found in hashes)


def test_another_salt_does_not_get_the_folder(suite_file, tmp_path):
    suite = load_suite(str(suite_file), Selection(seeds="1", salt=SALT))
    run_suite(suite, tmp_path / "r", workers=0)
    other = load_suite(str(suite_file), Selection(seeds="1", salt="00"))
    with pytest.raises(RunConflictError, match=f"{SALT}. Got 00 instead"):
        run_suite(other, tmp_path / "r", workers=0)
    assert run_suite(suite, tmp_path / "r", workers=0).found == 2


def test_without_any_metric_nothing_is_run(suite_file, tmp_path, monkeypatch):
    suite = load_suite(str(suite_file))
    monkeypatch.setattr(METRICS, "_found", {})
    monkeypatch.setattr(METRICS, "_local", {})
    with pytest.raises(UsageError, match="Metrics must be registered"):
        run_suite(suite, tmp_path / "r", workers=0)
    assert not (tmp_path / "r").exists()


def test_another_suite_does_not_get_the_folder(suite_file, tmp_path):
    out = tmp_path / "run"
    run_suite(load_suite(str(suite_file), Selection(seeds="1")), out, workers=0)
    before = digests(out)
    with pytest.raises(RunConflictError, match=r"They differ in seeds, navigators\."):
        run_suite(
            load_suite(str(suite_file), Selection(seeds="2", navigators=("orca",))), out, workers=0
        )
    assert digests(out) == before


def test_more_seeds_extend_the_run(suite_file, tmp_path):
    def run(out, seeds):
        return run_suite(
            load_suite(str(suite_file), Selection(seeds=seeds, salt=SALT)), out, workers=0
        )

    grown, whole = tmp_path / "grown", tmp_path / "whole"
    run(grown, "2:3")
    summary = run(grown, "2:5")
    assert (summary.found, summary.stored) == (2, 6)
    summary = run(grown, "0:2")
    assert (summary.found, summary.stored) == (0, 4)
    run(whole, "0:5")
    assert load_manifest(grown).suite == load_manifest(whole).suite
    assert digests(grown) == digests(whole)
    fewer = run(grown, "3")
    assert (fewer.found, fewer.stored) == (6, 6)
    assert load_manifest(grown).suite["seeds"] == [0, 5]


def test_seeds_with_a_gap_before_them_and_those_of_a_shard_do_not_extend(suite_file, tmp_path):
    def suite(seeds):
        return load_suite(str(suite_file), Selection(seeds=seeds, salt=SALT))

    run_suite(suite("1"), tmp_path / "whole", workers=0)
    with pytest.raises(RunConflictError, match=r"must touch .* 0:1\. Use the seeds 0:4"):
        run_suite(suite("3:4"), tmp_path / "whole", workers=0)
    run_suite(suite("2"), tmp_path / "share", workers=0, shard=Shard(1, 2))
    with pytest.raises(RunConflictError, match=r"They differ in seeds\."):
        run_suite(suite("3"), tmp_path / "share", workers=0, shard=Shard(1, 2))


@pytest.mark.parametrize("workers", [0, 1])
def test_failures_are_counted_by_reason(suite_file, tmp_path, workers, in_the_east):
    chosen = Selection(navigators=("troubled_navigators:Raises",))
    summary = run_suite(load_suite(str(suite_file), chosen), tmp_path / "r", workers=workers)
    failed = [e for e in read_episodes(tmp_path / "r") if e.failure]
    assert all(in_the_east(e) for e in failed)
    ((_, reason),) = summary.failures
    where = r"act raised ValueError: lost my way \(troubled_navigators.py:\d+\) at t = 0.6 s"
    assert re.fullmatch(where, reason)
    assert summary.failures == {("troubled_navigators:Raises", reason): len(failed)}
    ((_, traceback),) = summary.tracebacks.items()
    assert {e.traceback for e in failed} == {traceback}
    assert 'raise ValueError("lost my\\nway")' in traceback
    assert str(tmp_path.parent) not in traceback
    assert 0 < len(failed) < 6


@pytest.mark.parametrize("workers", [0, 1])
@pytest.mark.parametrize("navigator", ["Unfit", "Unmade"])
def test_what_is_not_installed_makes_a_cell_n_a_and_stops_nobody_else(
    suite_file, tmp_path, workers, navigator, small_tasks
):
    chosen = Selection(navigators=(f"troubled_navigators:{navigator}", "walk"))
    suite, out = load_suite(str(suite_file), chosen), tmp_path / "r"
    summary = run_suite(suite, out, workers=workers)
    why = f"{navigator} needs an extra: pip install 'benchnav[plan]'"
    assert [(c.contestant.label, said) for c, said in summary.not_applicable] == [
        (f"troubled_navigators:{navigator}", why)
    ]
    assert (summary.total, summary.stored, summary.failures) == (6, 6, {})
    assert {e.identity.navigator for e in read_episodes(out)} == {"walk"}
    assert [cell["reason"] for cell in load_manifest(out).cells] == [why, ""]


def test_a_cell_is_run_once_its_extra_is_there(suite_file, tmp_path, monkeypatch):
    import troubled_navigators

    chosen = Selection(navigators=("troubled_navigators:Unfit",))
    suite, out = load_suite(str(suite_file), chosen), tmp_path / "r"
    assert run_suite(suite, out, workers=0).stored == 0
    monkeypatch.setattr(troubled_navigators.Unfit, "reset", troubled_navigators.Walk.reset)
    summary = run_suite(suite, out, workers=0)
    assert (summary.stored, summary.not_applicable) == (6, [])
    assert len(list(read_episodes(out))) == 6


def test_a_navigator_that_kills_its_process_pays_for_its_own_episodes(
    suite_file, tmp_path, in_the_east
):
    chosen = Selection(navigators=("troubled_navigators:Dies", "walk"), seeds="3")
    told = Counting()
    run_suite(load_suite(str(suite_file), chosen), tmp_path / "r", workers=2, progress=told)
    assert told.done == 6
    episodes = list(read_episodes(tmp_path / "r"))
    walk = {e.identity.seed: e for e in episodes if e.identity.navigator == "walk"}
    dies = {e.identity.seed: e for e in episodes if e.identity.navigator != "walk"}
    assert sorted(walk) == sorted(dies) == [0, 1, 2]
    assert 0 < sum(map(in_the_east, walk.values())) < 3
    for seed, episode in dies.items():
        if in_the_east(walk[seed]):
            assert episode.failure == "the navigator's process ended with exit status 7"
        else:
            assert (episode.failure, episode.digest) == ("", walk[seed].digest)


def test_a_scenario_that_cannot_be_drawn_stops_the_run_and_says_so(
    scenario_file, suite_file, tmp_path
):
    full = scenario_file.read_text().replace("count: {integers: [1, 3]}", "count: 90")
    (tmp_path / "full.yaml").write_text(full)
    chosen = Selection(scenarios=(str(tmp_path / "full.yaml"),), navigators=("orca",))
    for workers in (0, 1):
        with pytest.raises(UnsolvableError, match="tiny/crossing"):
            run_suite(
                load_suite(str(suite_file), chosen), tmp_path / f"r{workers}", workers=workers
            )


def test_what_a_navigator_prints_is_not_a_result(suite_file, tmp_path, capfd, monkeypatch):
    monkeypatch.setattr(fork_server, "_servers", [])  # another one writes where this test reads
    chosen = Selection(navigators=("troubled_navigators:Talks",))
    run_suite(load_suite(str(suite_file), chosen), tmp_path / "r", workers=1)
    out, err = capfd.readouterr()
    assert out == ""
    assert "hello from a navigator" in err


def test_a_navigator_of_this_process_runs_in_this_process(suite_file, tmp_path):
    from troubled_navigators import Walk

    register_navigator("mine-for-a-test")(type("Mine", (Walk,), {}))
    chosen = Selection(navigators=("mine-for-a-test",))
    suite = load_suite(str(suite_file), chosen)
    for workers in (0, 1):
        summary = run_suite(suite, tmp_path / f"{workers}", workers=workers)
        assert summary.stored == 6
        assert summary.in_process == (("mine-for-a-test",) if workers else ())


def _heed_ctrl_c():
    """Also where the tests run in the background of a shell, which has its jobs ignore it."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.mark.slow
def test_ctrl_c_keeps_whole_parts_and_the_run_ends_in_the_same_table(suite_file, tmp_path):
    """The real thing: a process, a signal, and the run again.

    So many seeds that most parts are still to come when the first is seen, on any machine.
    """
    seeds = 1600
    out, whole = tmp_path / "run", tmp_path / "whole"
    command = [
        sys.executable, "-c", "from benchnav.cli.main import main; main()",
        "run", str(suite_file), "--seeds", str(seeds), "--navigator", "orca", "--workers", "1",
    ]  # fmt: skip
    process = subprocess.Popen(
        [*command, "--out", str(out)], stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        start_new_session=True, preexec_fn=_heed_ctrl_c,
    )  # fmt: skip
    deadline = time.monotonic() + 300  # the worker may have to compile first
    while not list(out.glob(f"parts/*/[!.]*{SEAL}")) and time.monotonic() < deadline:
        time.sleep(0.01)
    os.killpg(process.pid, signal.SIGINT)
    stdout, stderr = process.communicate(timeout=60)
    assert process.returncode == 130
    assert stdout == ""
    assert "Interrupted by SIGINT: " in stderr
    assert f"with the folder {out} as out" in stderr
    assert "Traceback" not in stderr
    stored = len(list(read_episodes(out)))
    assert 0 < stored < seeds
    assert not list(out.glob("parts/*/.writing*"))
    chosen = Selection(seeds=str(seeds), navigators=("orca",), salt=load_manifest(out).salt)
    resumed = run_suite(load_suite(str(suite_file), chosen), out, workers=1)
    assert resumed.found == stored
    run_suite(load_suite(str(suite_file), chosen), whole, workers=1)
    assert table(out) == table(whole)


@pytest.mark.parametrize(
    ("seeds", "effort", "expected"),
    [
        (range(5), 1, [(0, 5)]),
        (range(64), 1, [(0, 64)]),
        (range(130), 1, [(0, 64), (64, 128), (128, 130)]),
        ([0, 1, 3, 4, 9], 1, [(0, 2), (3, 5), (9, 10)]),
        (range(3), 1e9, [(0, 1), (1, 2), (2, 3)]),
        ([], 1, []),
    ],
)
def test_tasks_cover_what_is_missing_once(seeds, effort, expected):
    assert list(chunks(seeds, effort)) == expected


@pytest.mark.parametrize(
    ("seeds", "workers", "joined"),
    [(0, 1, 1), (100, 0, 1), (256, 0, 2), (300, 2, 1), (1000, 2, 3), (10**6, 2, 4)],
)
def test_a_long_run_has_larger_tasks(seeds, workers, joined):
    assert joined_chunks(seeds, workers) == joined


def test_only_short_episodes_share_a_larger_task():
    assert list(chunks(range(300), 1, 4)) == [(0, 256), (256, 300)]
    assert list(chunks(range(100), 1e4, 4)) == [(0, 64), (64, 100)]


def test_two_runs_into_one_folder_at_once_are_refused(suite_file, tmp_path):
    suite, out = load_suite(str(suite_file)), tmp_path / "run"
    run_suite(suite, out, workers=0)
    with (
        RunFolder.open(out).writing(),
        pytest.raises(RunConflictError, match="must have one writer"),
    ):
        run_suite(suite, out, workers=0)


def test_who_uses_no_map_is_measured_once_and_stands_in_every_track(tmp_path, suite_file):
    suite = load_suite(
        str(suite_file), Selection(tracks=("known", "unknown"), navigators=("orca",), seeds="2")
    )
    run = tmp_path / "run"
    assert run_suite(suite, run, workers=0).total == 2
    assert {e.identity.track for e in read_episodes(run)} == {"unknown"}
    for results in (read_results(run), measure_again(run, all_metrics())):
        known, unknown = (
            [
                {**row, "track": "", "value": repr(row["value"])}
                for row in results.to_pylist()
                if row["track"] == track and not row["metric"].startswith(TIMINGS)
            ]
            for track in ("known", "unknown")
        )
        assert known == unknown != []
