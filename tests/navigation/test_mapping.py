"""Agents that know nothing map what they sense, and get out of dead ends."""

import numpy as np
import pytest

from benchnav.episode.episode import Status
from benchnav.runner.rollout import Assignment, rollout
from benchnav.scenario.catalogue import find
from benchnav.world.build import build


def arrived(navigator, name, seeds, track="unknown"):
    """Share of the agents that came to their goals, on validation worlds."""
    scenario = find(name)
    worlds = [(seed, build(scenario, "validation", seed)) for seed in seeds]
    who = Assignment(scenario.identity, scenario.hash, "validation", track, "it", navigator)
    there = []
    for batch in rollout(who, worlds):
        for episode in batch:
            assert not episode.failure
            there.append(episode.status[-1, episode.world.agents.evaluated] == Status.ARRIVED)
    return float(np.concatenate(there).mean())


def test_a_dead_end_is_left_by_who_maps_it_alone():
    assert arrived("mapping+grid.theta-star+orca", "trap/u", range(4)) > 0.9
    assert arrived("none+orca", "trap/u", range(4)) == 0.0


@pytest.mark.slow
def test_a_maze_is_crossed_without_a_map():
    assert arrived("mapping+grid.theta-star+path-following", "maze/grid", range(4)) > 0.5


def test_what_is_mapped_depends_neither_on_batch_nor_on_other_worlds():
    scenario = find("trap/u")
    worlds = [(seed, build(scenario, "validation", seed)) for seed in range(3)]
    who = Assignment(
        scenario.identity, scenario.hash, "validation", "unknown", "it",
        "mapping+grid.astar+orca", salt="00",
    )  # fmt: skip
    together = {e.identity.seed: e for batch in rollout(who, worlds) for e in batch}
    for world in worlds:
        ((alone,),) = rollout(who, [world])
        np.testing.assert_array_equal(alone.position, together[world[0]].position)
