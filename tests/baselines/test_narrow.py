"""Planner and controller agree on what is passable, or it is remarked."""

import numpy as np
import pytest

from benchnav.arena.solid import Kind, Solid
from benchnav.generation.build import build
from benchnav.metrics.measure import load_metric
from benchnav.metrics.metric import evaluate
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import PLANNERS
from benchnav.runner.rollouts.rollout import Assignment, rollout
from benchnav.scenario.load import scenario_from_text
from tests.baselines.planning import arena, box

RADIUS = 0.3
SCENARIO = """
name: tests/narrow
bounds: [-6, -4, 6, 4]
walls:
  - {{shape: {{type: box, width: 0.2, depth: {depth}}}, at: [0, {at}]}}
  - {{shape: {{type: box, width: 0.2, depth: {depth}}}, at: [0, -{at}]}}
teams:
  - name: all
    radius: 0.3
    max_speed: 1.2
    start: {{type: points, points: [[-4, 2]]}}
    goal: {{type: points, points: [[4, -2]]}}
clock: {{dt: 0.2, substeps: 2, horizon: 60}}
"""


def door(gap):
    """A wall at x = 10 with a gap in its middle."""
    low, high = box(9.9, -1.0, 0.2, 11.0 - gap / 2), box(9.9, 10.0 + gap / 2, 0.2, 11.0 - gap / 2)
    return arena(Solid(Kind.STATIC, (low,)), Solid(Kind.STATIC, (high,)))


def plan(name, gap, start=(4.0, 12.0), goal=(16.0, 8.0)):
    rng = np.random.default_rng(0)
    return make(PLANNERS, name).plan(door(gap), np.array(start), np.array(goal), RADIUS, 0.2, rng)


@pytest.mark.parametrize("planner", ["navmesh", "visibility"])
def test_a_plan_says_how_little_room_a_narrow_place_leaves(planner):
    assert plan(planner, 1.2).clearance == np.inf
    narrow = plan(planner, 0.62)
    assert narrow.solved
    assert 0.0 < narrow.clearance <= 0.01
    tighter = plan(planner, 0.604)
    assert (tighter.solved, tighter.clearance) == (True, 0.0)
    assert not plan(planner, 0.58).solved


def test_an_end_beside_one_wall_is_not_a_narrow_place():
    assert plan("navmesh", 1.2, start=(9.58, 6.0)).clearance == np.inf
    assert plan("navmesh", 1.2, start=(9.595, 6.0)).clearance == np.inf
    assert plan("navmesh", 0.66, start=(10.0, 10.0)).clearance <= 0.03
    assert 0.0 < plan("navmesh", 0.62, start=(10.0, 10.0)).clearance <= 0.01


def episode(navigator, gap):
    depth = (8.0 - gap) / 2
    text = SCENARIO.format(depth=depth, at=(4.0 + gap / 2) / 2)
    scenario = scenario_from_text(text, "narrow.yaml")
    about = Assignment(scenario.identity, scenario.hash, "test", "known", navigator, navigator)
    ((found,),) = rollout(about, [(0, build(scenario, "test", 0))])
    return found, evaluate(load_metric("success"), found, found.world.agents.evaluated)[0]


@pytest.mark.slow
@pytest.mark.parametrize("gap", [0.62, 0.64, 0.68])
@pytest.mark.parametrize("navigator", ["navmesh+orca", "visibility+orca", "navmesh+orca-ppo"])
def test_orca_follows_its_path_through_a_narrow_door(navigator, gap):
    found, success = episode(navigator, gap)
    assert (success, found.failure, found.remarks) == (1.0, "", ())


@pytest.mark.slow
def test_a_controller_that_stops_there_is_remarked():
    found, _ = episode("navmesh+dwa", 0.62)
    assert "narrower than the planner's clearance" in found.remarks[0]
    assert episode("navmesh+dwa", 1.4)[0].remarks == ()
