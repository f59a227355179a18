"""A navigator in a process of its own does what it does in this one, also where it fails."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from benchnav.errors import MissingExtraError, UsageError
from benchnav.generation.build import build
from benchnav.isolation import isolated, process_pool, sandbox
from benchnav.navigation.navigator import AgentNavigator
from benchnav.plugins import NAVIGATORS
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.rollouts import rollout
from benchnav.runner.rollouts.latency import latency, peak_memory
from benchnav.runner.rollouts.rehearsal import perform
from benchnav.runner.rollouts.rollout import Assignment
from benchnav.runner.run import run_suite
from benchnav.scenario.catalogue import find
from benchnav.store.runs.reading import read_episodes


@pytest.fixture(autouse=True)
def nobody_stays():
    yield
    process_pool.stop_all()


def told(episodes):
    return {
        seed: (e.digest, e.failure, e.traceback, e.reproducible) for seed, e in episodes.items()
    }


@pytest.mark.parametrize(
    "navigator",
    [
        "Walk", "Raises", "Nan", "Shape", "Nothing", "Leaves", "ResetRaises", "Vandal", "Talks",
        "Staggered", "Alone", "Agentwise", "Rotor", "straight-line",
    ],
)  # fmt: skip
def test_it_does_and_fails_as_in_the_runners_process(play, navigator):
    here = play(navigator, salt="0a")
    assert told(play(navigator, salt="0a", isolated=True)) == told(here)


@pytest.mark.parametrize(
    ("name", "navigator", "track", "most"),
    [
        ("leaders/moving-furniture", "orca", "unknown", 1),
        ("leaders/moving-furniture", "ompl.rrt-connect+orca", "known", 3),
        ("leaders/moved", "ompl.prm+path-following", "stale", 64),
        ("leaders/dynamic", "mapping+grid.theta-star+social-force", "unknown", 3),
        ("leaders/dynamic", "recurrent-ppo", "unknown", 3),
        ("leaders/dynamic", "q-learning", "unknown", 1),
    ],
)
def test_what_ships_answers_to_the_last_bit_in_any_batch(name, navigator, track, most, monkeypatch):
    if "ompl" in navigator:
        pytest.importorskip("ompl")
    if "ppo" in navigator:
        pytest.importorskip("torch")
    scenario = find(name)
    worlds = [(seed, build(scenario, "test", seed)) for seed in range(4)]

    def digests(apart):
        assignment = Assignment(
            scenario.identity, scenario.hash, "test", track, navigator, navigator,
            scenario.driver_specs, salt="0a", isolated=apart,
        )  # fmt: skip
        episodes = [e for batch in rollout.rollout(assignment, worlds) for e in batch]
        assert {e.failure for e in episodes} == {""}
        return {e.identity.seed: (e.digest, e.reproducible) for e in episodes}

    here = digests(False)
    monkeypatch.setattr(rollout, "MAX_WORLDS", most)
    assert digests(True) == here


def test_rehearsals_and_remarks_pass(scenario):
    pytest.importorskip("shapely")
    crossing = find("groups/crossing:followers=4")
    worlds = [(seed, build(crossing, "test", seed)) for seed in range(2)]
    spec = {"type": "guided-crowd", "rehearsal": 2, "leader": "straight-line"}

    def performed(apart):
        assignment = Assignment(
            crossing.identity, crossing.hash, "test", "unknown", "guided", spec,
            crossing.driver_specs, salt="0a", rehearsals=2, leader="straight-line",
            isolated=apart,
        )  # fmt: skip
        done = [p for batch in perform(assignment, worlds) for p in batch]
        return {
            p.episode.identity.seed: (
                p.episode.digest, p.episode.remarks, p.episode.failure,
                [e.digest for e in p.rehearsed.episodes],
            )
            for p in done
        }  # fmt: skip

    here = performed(False)
    assert performed(True) == here
    assert all(remarks for _, remarks, _, _ in here.values())  # straight-line leads nobody far


def test_who_takes_the_process_along_is_charged_with_the_cause(play, in_the_east):
    episodes = play("Dies", isolated=True)
    for episode in episodes.values():
        cause = "act: its process ended with exit status 7 at t = 0.6 s"
        assert episode.failure == (cause if in_the_east(episode) else "")
    assert len({e.failure for e in episodes.values()}) == 2


def test_who_hangs_is_charged_and_the_run_goes_on(scenario_file, troubled, tmp_path, in_the_east):
    path = tmp_path / "suite.yaml"
    path.write_text(
        f"name: small\nscenarios: [{scenario_file}]\nseeds: '3:5'\nnavigators:\n"
        "  - {type: 'troubled_navigators:Sleeps', label: sleeps}\n"
        "  - {type: 'troubled_navigators:Walk', label: walk}\n"
    )
    out = tmp_path / "run"
    run_suite(load_suite(str(path), Selection(isolate=True)), out, workers=1, timeout=3.0)
    episodes = [*read_episodes(out)]
    assert len(episodes) == 4
    for episode in episodes:
        guilty = episode.identity.navigator == "sleeps" and in_the_east(episode)
        cause = "the navigator's process did not return from act at t = 0.6 s within 3 s"
        assert episode.failure == (cause if guilty else "")
    assert sum(bool(e.failure) for e in episodes) == 1


def test_what_is_not_installed_is_no_failure(play):
    with pytest.raises(MissingExtraError, match=r"benchnav\[plan\]"):
        play("Unmade", isolated=True)
    with pytest.raises(MissingExtraError, match=r"benchnav\[plan\]"):
        play("Unfit", isolated=True)


def test_a_process_serves_one_cell_and_stays_warm_in_it(play, monkeypatch):
    begun = []
    honest = isolated.Process
    monkeypatch.setattr(isolated, "Process", lambda *of: begun.append(of) or honest(*of))
    monkeypatch.setattr(rollout, "MAX_WORLDS", 2)
    play("straight-line", isolated=True, track="known")
    assert len(begun) == 1
    play("straight-line", isolated=True, track="unknown")
    assert len(begun) == 2


def test_latency_and_memory_are_those_of_its_process(scenario):
    world = build(scenario, "test", 0)
    assignment = Assignment(
        scenario.identity, scenario.hash, "test", "known", "x", "straight-line",
        scenario.driver_specs, salt="0a", isolated=True,
    )  # fmt: skip
    assert (latency(assignment, (0, world)) > 0).all()
    (process,) = process_pool._KEPT.values()
    assert process.peak_memory() > 10 << 20
    assert peak_memory() > process.peak_memory()


def test_the_suite_knows_of_isolated_navigators_what_it_knows_of_others():
    names = ("orca", "q-learning", "guided-crowd", "none+dwa", "ompl.rrt-star+orca")
    here = load_suite("quick", Selection(navigators=names))
    there = load_suite("quick", Selection(navigators=names, isolate=True))
    for one, other in zip(here.contestants, there.contestants, strict=True):
        assert (one.mode, other.mode) == ("in-process", "isolated")
        assert one.hash != other.hash
        for name in ("spec", "source", "required", "training", "fingerprint", "rehearsal", "unfit"):
            assert getattr(one, name) == getattr(other, name)
    assert [c.reason for c in here.jobs()] == [c.reason for c in there.jobs()]
    modes = [entry["mode"] for entry in there.resolved()["navigators"]]
    assert modes == ["isolated"] * len(names)


def test_what_another_process_cannot_import_is_refused():
    @NAVIGATORS.register("of-this-process")
    class Local(AgentNavigator):
        def act_agent(self, view, briefing):
            return view.goal - view.position

    try:
        with pytest.raises(UsageError, match="registered in this process alone"):
            load_suite("quick", Selection(navigators=("of-this-process",), isolate=True))
    finally:
        del NAVIGATORS._local["of-this-process"]


def test_it_ends_with_a_runner_that_is_killed(tmp_path):
    script = (
        "import os, sys, time\n"
        "from benchnav.isolation.navigator_process import Process\n"
        "p = Process([sys.executable, '-c', 'import time; time.sleep(60)'])\n"
        "time.sleep(0.5); print(p._popen.pid, flush=True); time.sleep(60)\n"
    )
    runner = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    child = int(runner.stdout.readline())
    os.kill(runner.pid, signal.SIGKILL)
    runner.wait()
    runner.stdout.close()
    if not sandbox.prefix():
        pytest.skip("nothing here ends a process with its parent")
    until = time.monotonic() + 10
    while time.monotonic() < until:
        try:
            os.kill(child, 0)
        except ProcessLookupError:
            return
        if ") Z " in Path(f"/proc/{child}/stat").read_text():  # ended; nobody asked yet
            return
        time.sleep(0.05)
    raise AssertionError("it outlived its runner")
