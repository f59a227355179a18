"""A navigator that hangs, leaks or dies costs its own episodes, and the suite goes on."""

import math
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from benchnav.errors import RunConflictError, UsageError
from benchnav.metrics.metric import Metric
from benchnav.navigation.command_check import kind_of
from benchnav.plugins import METRICS
from benchnav.processes.process_tree import memory_is_known, tree
from benchnav.runner.plan import prepare as start_module
from benchnav.runner.plan import task as task_module
from benchnav.runner.plan.limits import Limits
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.run import run_suite
from benchnav.store.runs.manifest import load_manifest
from benchnav.store.runs.reading import read_episodes, read_results

SEEDS = range(3, 5)  # guilty, innocent
needs_memory = pytest.mark.skipif(not memory_is_known(), reason="the system does not tell memory")


@pytest.fixture
def suite_file(tmp_path, scenario_file, troubled):
    path = tmp_path / "suite.yaml"
    path.write_text(
        f"name: small\nscenarios: [{scenario_file}]\n"
        f"navigators: [{{type: 'troubled_navigators:Walk', label: walk}}]\nseeds: '3:5'\n"
    )
    return path


@pytest.fixture
def held(suite_file, tmp_path, in_the_east):
    """A navigator and limits → its failures by seed; beside it the walk that never fails."""

    def held(navigator, **limits):
        chosen = Selection(navigators=(f"troubled_navigators:{navigator}", "walk"))
        out = tmp_path / navigator
        run_suite(load_suite(str(suite_file), chosen), out, workers=1, **limits)
        episodes = list(read_episodes(out))
        walk = {e.identity.seed: e for e in episodes if e.identity.navigator == "walk"}
        other = {e.identity.seed: e for e in episodes if e.identity.navigator != "walk"}
        assert sorted(walk) == sorted(other) == list(SEEDS)
        assert not any(e.failure for e in walk.values())
        guilty = {seed for seed, e in walk.items() if in_the_east(e)}
        assert guilty == {3}
        assert (other[4].failure, other[4].digest) == ("", walk[4].digest)
        return other[3].failure

    return held


@pytest.mark.parametrize("navigator", ["Sleeps", "Spins"])
def test_a_call_that_does_not_return_costs_its_own_episodes(held, navigator):
    assert held(navigator, timeout=2.0) == (
        "the navigator's process did not return from act at t = 0.6 s within 2 s"
    )


@needs_memory
def test_who_leaks_past_the_limit_pays_for_its_own_episodes(held):
    why = "the navigator's process held more than 1 GB of memory"
    assert held("Leaks", memory=1.0) == why


def test_a_signal_is_named(held):
    assert held("Crashes") == "the navigator's process was killed by SIGSEGV"


@needs_memory
def test_what_former_worlds_left_behind_is_charged_to_nobody(suite_file, tmp_path, monkeypatch):
    monkeypatch.setattr(task_module, "CHUNK", 2)
    chosen = Selection(navigators=("troubled_navigators:Hoards",), seeds="8")
    suite, out = load_suite(str(suite_file), chosen), tmp_path / "run"
    summary = run_suite(suite, out, workers=1, memory=0.9)
    assert (summary.stored, summary.failures) == (8, {})


def test_a_navigator_that_cannot_be_made_in_a_worker_fails_there(suite_file, tmp_path):
    chosen = Selection(navigators=("troubled_navigators:NotThere", "walk"))
    summary = run_suite(load_suite(str(suite_file), chosen), tmp_path / "run", workers=1)
    assert summary.stored == 4
    (((label, reason), episodes),) = summary.failures.items()
    assert (label, episodes) == ("troubled_navigators:NotThere", 2)
    assert re.search(
        r"cannot be made: OSError: not there \(troubled_navigators.py:\d+\)\.$", reason
    )


def test_limits_stand_in_the_manifest_and_stay_those_of_the_run(suite_file, tmp_path):
    suite, out = load_suite(str(suite_file)), tmp_path / "run"
    run_suite(suite, out, workers=1, timeout=40.0)
    assert load_manifest(out).limits == {"timeout_seconds": 40.0, "memory_gigabytes": 4.0}
    assert run_suite(suite, out, workers=1).found == 2
    assert run_suite(suite, out, workers=1, timeout=40.0).found == 2
    with pytest.raises(RunConflictError, match=r"40 s a call and 4 GB a worker\. Got 50 s a call"):
        run_suite(suite, out, workers=1, timeout=50.0)


def test_limits_that_cannot_be_kept_are_refused(suite_file, tmp_path, monkeypatch):
    suite, out = load_suite(str(suite_file)), tmp_path / "run"
    for wrong in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(UsageError, match="timeout must be above 0"):
            run_suite(suite, out, workers=1, timeout=wrong)
    with pytest.raises(UsageError, match="Got 0 workers"):
        run_suite(suite, out, workers=0, memory=1.0)
    monkeypatch.setattr(start_module, "memory_is_known", lambda: False)
    with pytest.raises(UsageError, match="memory limit is not supported here"):
        run_suite(suite, out, workers=1, memory=1.0)
    assert not out.exists()
    assert Limits.of({}) == Limits()  # a run of before there were limits


def test_a_metric_that_raises_costs_its_values_and_the_run_goes_on(suite_file, tmp_path):
    def broken(episode):
        if episode.identity.seed == 4:
            raise ZeroDivisionError("oh")
        return episode.arrival * 0.0

    METRICS.register("tests_broken")(
        Metric(
            name="tests_broken",
            title="t",
            unit="",
            better="higher",
            low=0.0,
            high=1.0,
            reference="r",
            function=broken,
        )
    )
    try:
        summary = run_suite(load_suite(str(suite_file)), tmp_path / "run", workers=0)
    finally:
        del METRICS._local["tests_broken"]
    assert summary.stored == 2
    ((name, fault),) = summary.missing
    assert name == "tests_broken"
    assert re.fullmatch(r"ZeroDivisionError: oh \(tests/runner/test_limits\.py:\d+\)", fault)
    assert "in broken" in summary.tracebacks["walk", kind_of(fault)]
    rows = read_results(tmp_path / "run").to_pylist()
    why = {r["seed"]: r["missing"] for r in rows if r["metric"] == "tests_broken"}
    assert why == {3: "", 4: fault}
    assert {r["missing"] for r in rows if r["metric"] != "tests_broken"} <= {
        "", "n/a: needs people",
        "n/a: needs the undisturbed world: key `undisturbed` of the suite",
    }  # fmt: skip


@needs_memory
def test_workers_end_with_a_parent_that_is_killed(suite_file, tmp_path):
    """Else they would write beside the run that goes on."""
    process = subprocess.Popen(
        [
            sys.executable, "-c", "from benchnav.cli.main import main; main()", "run",
            str(suite_file), "--navigator", "troubled_navigators:Sleeps", "--workers", "2",
            "--out", str(tmp_path / "run"),
        ],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
    )  # fmt: skip
    deadline = time.monotonic() + 60
    while len(workers := tree(process.pid)[1:]) < 1 and time.monotonic() < deadline:
        time.sleep(0.02)
    time.sleep(1.0)  # at work
    workers = tree(process.pid)[1:]
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    left = set(workers)
    while left and time.monotonic() < deadline:
        left = {pid for pid in left if is_running(pid)}
        time.sleep(0.02)
    assert workers
    assert not left


def is_running(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().split(") ")[1][0] != "Z"
    except FileNotFoundError:
        return False
