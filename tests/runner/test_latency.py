"""Latency is taken apart, for one world alone, and nothing that is scored knows of it."""

import sys

import pytest

from benchnav.generation.build import build
from benchnav.runner.plan import task as task_module
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.rollouts import latency as module
from benchnav.runner.rollouts.latency import latency, peak_memory
from benchnav.runner.rollouts.rollout import Assignment
from benchnav.runner.run import run_suite
from benchnav.store.runs.reading import read_episodes


@pytest.fixture
def suite(tmp_path, scenario_file, troubled):
    path = tmp_path / "suite.yaml"
    path.write_text(
        f"name: small\nscenarios: [{scenario_file}]\n"
        "navigators: [orca, {type: 'troubled_navigators:Walk', label: walk}]\nseeds: '3:9'\n"
    )
    return load_suite(str(path), Selection(salt="5a"))


@pytest.mark.parametrize("workers", [0, 1])
def test_each_cell_takes_it_once_and_every_episode_knows_the_memory(
    suite, tmp_path, monkeypatch, workers
):
    monkeypatch.setattr(task_module, "CHUNK", 4)
    run_suite(suite, tmp_path / "r", workers=workers)
    episodes = list(read_episodes(tmp_path / "r"))
    timed = [e for e in episodes if e.timings.latency is not None]
    assert sorted((e.identity.navigator, e.identity.seed) for e in timed) == [
        ("orca", 3), ("walk", 3),
    ]  # fmt: skip
    for episode in timed:
        assert len(episode.timings.latency) == min(module.DECISIONS, len(episode.requested))
        assert (episode.timings.latency > 0).all()
    assert all(10e6 < e.timings.memory < 1e12 for e in episodes)


def test_it_changes_nothing_that_is_scored(suite, tmp_path, monkeypatch):
    def digests(run):
        return {(e.identity.navigator, e.identity.seed): e.digest for e in read_episodes(run)}

    run_suite(suite, tmp_path / "with", workers=0)
    monkeypatch.setattr(task_module, "latency", lambda *_: None)
    run_suite(suite, tmp_path / "without", workers=0)
    assert digests(tmp_path / "with") == digests(tmp_path / "without")


def test_it_serves_one_world_for_a_few_decisions(scenario, troubled, monkeypatch):
    from troubled_navigators import Sees

    Sees.shown.clear()
    monkeypatch.setattr(module, "DECISIONS", 5)
    about = Assignment(
        scenario.identity, scenario.hash, "test", "known", "sees", "troubled_navigators:Sees",
        scenario.driver_specs,
    )  # fmt: skip
    world = (0, build(scenario, "test", 0))
    taken = latency(about, world)
    assert taken is not None
    assert taken.shape == (5,)
    assert [len(shown) for shown in Sees.shown] == [1] * 5


def test_a_navigator_that_fails_in_it_has_none(scenario, troubled):
    about = Assignment(
        scenario.identity, scenario.hash, "test", "known", "x", "straight-line",
        ("troubled_navigators:ResetRaises",),
    )  # fmt: skip
    worlds = [(seed, build(scenario, "test", seed)) for seed in range(9)]
    taken = [latency(about, world) for world in worlds]
    assert any(found is None for found in taken)
    assert any(found is not None for found in taken)


def test_a_system_that_does_not_tell_memory_is_no_failure(monkeypatch):
    assert peak_memory() > 10e6
    monkeypatch.setitem(sys.modules, "resource", None)
    assert peak_memory() is None
