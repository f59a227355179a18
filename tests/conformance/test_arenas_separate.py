"""Arenas that must tell methods apart do: what only avoids is trapped, what plans gets out."""

import pytest

from benchnav.generation.build import build
from benchnav.metrics.success import arrival, success
from benchnav.runner.rollouts.rollout import Assignment, rollout
from benchnav.scenario.catalogue import find

pytest.importorskip("ompl")
SEEDS = range(10)
MOST = 0.2  # of its agents that a local avoider alone may bring home


def rates(name, navigator):
    """Mean shares of agents that arrived, and that did so without a collision."""
    scenario = find(name)
    worlds = [(seed, build(scenario, "test", seed)) for seed in SEEDS]
    assignment = Assignment(scenario.identity, scenario.hash, "test", "known", navigator, navigator)
    episodes = [episode for batch in rollout(assignment, worlds) for episode in batch]
    assert [episode.failure for episode in episodes] == [""] * len(SEEDS)
    came = sum(float(arrival(episode).mean()) for episode in episodes) / len(SEEDS)
    clean = sum(float(success(episode).mean()) for episode in episodes) / len(SEEDS)
    print(f"{name} {navigator}: arrived {came:.3f}, success {clean:.3f}")
    return came, clean


@pytest.mark.parametrize("name", ["trap/u", "maze/grid"])
def test_avoiding_alone_is_trapped_and_planning_gets_out(name):
    for local in ("orca", "straight-line"):
        came, clean = rates(name, local)
        assert clean <= came <= MOST
    came, clean = rates(name, "ompl-orca")
    assert came >= clean > 0.7
