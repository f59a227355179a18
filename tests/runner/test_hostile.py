"""Whatever a navigator does to its process costs its own episodes, and changes no other's."""

import json
import os
import subprocess
import sys
import time

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from benchnav.metrics.measure import own_metrics
from benchnav.processes.process_tree import memory_is_known
from benchnav.runner.execute import worker_slot
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.run import run_suite
from benchnav.store.runs.reading import read_episodes, read_results
from benchnav.store.runs.run_folder import RunFolder

HOSTILE = """
import math, os, resource, signal, subprocess, sys, threading, time
import numpy as np
from benchnav.navigation.navigator import Navigator

class _Loud(Exception):
    def __str__(self):
        raise RuntimeError("I do not speak")

class _Endless(Exception):
    def __str__(self):
        while True:
            time.sleep(0.1)

def nothing(): pass
def raises(): raise ValueError("no \\ud800 text \\x1b[31m" + "x" * 2_000)
def loud(): raise _Loud
def endless(): raise _Endless
def interrupts(): raise KeyboardInterrupt
def leaves(): sys.exit(0)
def drops(): os._exit(0)
def dies(): os.kill(os.getpid(), signal.SIGKILL)
def hangs():
    while True:
        time.sleep(0.1)
def stops(): os.kill(os.getpid(), signal.SIGSTOP)
def forks(): os.fork()
def orphans(): subprocess.Popen(["sleep", "86399"], start_new_session=True)
def recursion(): sys.setrecursionlimit(60)
def patches():
    math.hypot = lambda *_: 7.0
    np.linalg.norm = lambda *_, **__: 7.0
def few_files(): resource.setrlimit(resource.RLIMIT_NOFILE, (3, 3))
def small_files(): resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))
def goes_away(): os.chdir("/")
def traps():
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGCHLD):
        signal.signal(number, lambda *_: None)
def writes():
    for file in range(3, 64):
        try:
            os.write(file, b"\\xff" * 4096)
        except OSError:
            pass
def closes(): os.closerange(3, 64)
def hogs():
    def spin():
        sys.setswitchinterval(1e9)
        int("7" * 400_000 + "1") if not hasattr(sys, "set_int_max_str_digits") else (
            sys.set_int_max_str_digits(0), 3 ** (3 ** 17) % 7)
        while True:
            pass
    threading.Thread(target=spin, daemon=True).start()
def kills_parent(): os.kill(os.getppid(), signal.SIGKILL)

WHAT = {name: f for name, f in list(vars().items()) if callable(f) and not name.startswith("_")
        and name not in ("Navigator",)}

class _Hostile(Navigator):
    where, what = "act", "nothing"
    begun = False  # in a worker: who asks it to introduce itself is no part of these tests
    def _at(self, place):
        if place == self.where and self.begun:
            WHAT[self.what]()
    def reset(self, briefings, rows):
        self.begun = True
        self._at("reset")
    def act(self, observation):
        self._at("act")
        return np.zeros((*observation.active.shape, 2))
    def remarks(self, row):
        self._at("remarks")
        return ()
    def __del__(self):
        self._at("__del__")

class Moody(_Hostile):
    # what it does may be another thing when somebody verifies its run
    what = property(lambda self: os.environ.get("MOOD", "nothing"))

for _where in ("reset", "act", "remarks", "__del__"):
    for _what in WHAT:
        _name = f"Hostile_{_where.strip('_')}_{_what}"
        globals()[_name] = type(_name, (_Hostile,), {"where": _where, "what": _what})
"""
QUICK = [
    "raises", "loud", "interrupts", "leaves", "drops", "dies", "forks", "orphans", "recursion",
    "patches", "few_files", "small_files", "goes_away", "traps", "writes", "closes",
]  # fmt: skip
WHERE = ["reset", "act", "remarks", "del"]


@pytest.fixture(scope="module")
def honest(tmp_path_factory):
    """A folder with the hostile module and a suite, and what the honest navigator's values are."""
    from tests.runner.conftest import SCENARIO

    folder = tmp_path_factory.mktemp("hostile")
    (folder / "hostile_navigators.py").write_text(HOSTILE)
    (folder / "tiny.yaml").write_text(SCENARIO.replace("horizon: 8", "horizon: 2"))
    (folder / "suite.yaml").write_text(
        "name: small\nscenarios: [tiny.yaml]\nseeds: 2\nnavigators: [straight-line]\n"
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(folder)
        patch.chdir(folder)
        run_suite(_suite(folder), folder / "honest", workers=1)
        yield folder, _values(folder / "honest")


def _suite(folder, *hostile):
    names = (*(f"hostile_navigators:{name}" for name in hostile), "straight-line")
    return load_suite(str(folder / "suite.yaml"), Selection(navigators=names, salt="5a" * 16))


def _values(run):
    rows = read_results(run).to_pylist()
    same = {metric.name for metric in own_metrics() if metric.verifiable}
    return {
        (r["seed"], r["role"], r["metric"]): repr(r["value"])
        for r in rows
        if r["navigator"] == "straight-line" and r["metric"] in same
    }


def _survives(honest, name, timeout=1.0):
    folder, values = honest
    out = folder / name
    summary = run_suite(_suite(folder, name), out, workers=1, timeout=timeout)
    assert summary.stored == 4
    kept = [
        (e.identity.navigator, e.identity.seed, e.failure)
        for e in read_episodes(out)
    ]  # fmt: skip
    assert sorted(k[:2] for k in kept) == [
        (label, seed)
        for label in (f"hostile_navigators:{name}", "straight-line")
        for seed in (0, 1)
    ]
    assert _values(out) == values
    assert not [why for label, _, why in kept if label == "straight-line" and why]
    assert not list(out.rglob(".writing*"))
    assert RunFolder.open(out).manifest.unguarded == ()
    return {why for label, _, why in kept if label != "straight-line"}


@settings(max_examples=12, suppress_health_check=list(HealthCheck), derandomize=True)
@given(st.sampled_from(WHERE), st.sampled_from(QUICK))
@pytest.mark.slow
def test_only_its_own_episodes_fail(honest, where, what):
    name = f"Hostile_{where}_{what}"
    if (honest[0] / name).exists():
        return
    _survives(honest, name)


HARD = ["endless", "hangs", "stops", "hogs", "kills_parent"]


@pytest.mark.parametrize("where", WHERE)
@pytest.mark.parametrize(
    "what",
    [
        *(pytest.param(what, marks=pytest.mark.soak) for what in QUICK),
        *(pytest.param(what, marks=pytest.mark.long) for what in HARD),
    ],
)
def test_only_its_own_episodes_fail_whatever_it_does(honest, where, what, monkeypatch):
    monkeypatch.setattr(worker_slot, "IDLE_SLACK", 2.0)  # what hangs in __del__ waits for it
    name = f"Hostile_{where}_{what}"
    if not (honest[0] / name).exists():
        _survives(honest, name)


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("Hostile_act_hangs", "did not return from act at t = 0 s within 1 s"),
        ("Hostile_act_endless", "did not return from act at t = 0 s within 1 s"),
        ("Hostile_remarks_drops", "ended with exit status 0"),
        ("Hostile_act_forks", "forked, and a call returned in both processes"),
        ("Hostile_reset_kills_parent", "was killed by SIGKILL"),
        ("Hostile_act_dies", "was killed by SIGKILL"),
    ],
)
@pytest.mark.slow
def test_the_reason_is_told(honest, name, why):
    if not (honest[0] / name).exists():
        assert _survives(honest, name) == {f"the navigator's process {why}"}


@pytest.mark.skipif(not memory_is_known(), reason="the system does not tell processes")
def test_what_a_worker_started_ends_with_it(honest):
    if not (honest[0] / "Hostile_act_orphans").exists():
        _survives(honest, "Hostile_act_orphans")
    deadline = time.monotonic() + 20.0
    while time.monotonic() < deadline and _sleepers():
        time.sleep(0.1)
    assert _sleepers() == []


def _sleepers():
    found = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True, check=True)
    return [line for line in found.stdout.splitlines() if line == "sleep 86399"]


def test_in_this_process_nothing_is_guarded_and_the_run_says_so(honest):
    folder, values = honest
    out = folder / "unguarded"
    run_suite(_suite(folder), out, workers=0)
    assert RunFolder.open(out).manifest.unguarded == ("straight-line",)
    assert _values(out) == values
    run_suite(_suite(folder), folder / "honest", workers=0)  # all is there: nothing ran here
    assert RunFolder.open(folder / "honest").manifest.unguarded == ()


METRICS = """
import os, time, math
import numpy as np
from benchnav.metrics.metric import Metric

def hangs(episode):
    if episode.identity.seed == 1:
        time.sleep(1000)
    return np.ones(len(episode.world.agents))
def dies(episode):
    os._exit(3)
def patches(episode):
    math.hypot = np.hypot = np.linalg.norm = lambda *_, **__: 7.0
    return np.zeros(len(episode.world.agents))
def metric(name, function):
    return Metric(name=name, title="t", unit="", better="higher", low=0.0, high=1.0,
                  reference="r", function=function)
HANGS = metric("a_hangs", hangs)
DIES = metric("a_dies", dies)
PATCHES = metric("a_patches", patches)
"""


def test_a_metric_of_a_plugin_costs_its_own_values(honest, tmp_path):
    folder, values = honest
    site = tmp_path / "site"
    info = site / "odd-0.1.dist-info"
    info.mkdir(parents=True)
    (site / "odd_metrics.py").write_text(METRICS)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: odd\nVersion: 0.1\n")
    (info / "entry_points.txt").write_text(
        "[benchnav.metrics]\na_hangs = odd_metrics:HANGS\na_dies = odd_metrics:DIES\n"
        "a_patches = odd_metrics:PATCHES\na_gone = odd_metrics:GONE\n"
    )
    run = str(tmp_path / "run")
    _command(
        folder, "run", "suite.yaml", "--out", run, "--timeout", "1", "--workers", "1",
        "--salt", "5a" * 16, PYTHONPATH=str(site),
    )  # fmt: skip
    rows = read_results(tmp_path / "run").to_pylist()
    said = {(r["metric"], r["seed"]): (r["value"], r["missing"]) for r in rows}
    assert said["a_hangs", 0] == (1.0, "")
    assert said["a_hangs", 1][1] == "it did not return within 1 s"
    assert said["a_dies", 0][1] == "its process ended, or sent what is no value"
    assert said["a_patches", 1] == (0.0, "")
    assert "a_gone" in said["a_gone", 0][1]
    assert _values(tmp_path / "run") == values
    report = _verified(folder, run, PYTHONPATH=str(site))
    assert (report["findings"], report["checked"]["episodes"]) == ([], 2)
    assert not [line for line in report["not_checked"] if "a_dies" in line]


def _command(folder, *arguments, status=0, **environment):
    done = subprocess.run(
        [sys.executable, "-c", "from benchnav.cli.main import main; main()", *arguments],
        cwd=folder, env={**os.environ, **environment}, capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert done.returncode == status, done.stderr
    return done.stdout


def _verified(folder, run, *options, status=0, **environment):
    asked = ("verify", run, "--json", "--twin", "0", "--workers", "1", *options)
    return json.loads(_command(folder, *asked, status=status, **environment))


@pytest.mark.parametrize("mood", ["hangs", "patches"])
@pytest.mark.slow
def test_who_verifies_a_run_is_as_safe_as_who_runs_it(honest, tmp_path, mood):
    folder, _ = honest
    run = str(tmp_path / "run")
    _command(
        folder, "run", "suite.yaml", "--navigator", "hostile_navigators:Moody",
        "--navigator", "straight-line", "--out", run, "--timeout", "1",
        PYTHONPATH=str(folder),
    )  # fmt: skip
    report = _verified(
        folder, run, "--rerun", status=mood != "patches", PYTHONPATH=str(folder), MOOD=mood
    )
    assert report["checked"]["rerun"] == 4
    assert {f["kind"] for f in report["findings"]} <= {"rerun"}
    assert not [f for f in report["findings"] if "straight-line" in f["where"]]
