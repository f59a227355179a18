"""Learned policies that follow a planner's waypoints."""

from dataclasses import replace

import numpy as np
import pytest

from benchnav.envs.encoders.encoder import Bodies
from benchnav.generation.build import build
from benchnav.metrics.success import success
from benchnav.navigation.controller import Guide
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import CONTROLLERS, NAVIGATORS
from benchnav.runner.rollouts.rollout import Assignment, rollout
from benchnav.scenario.catalogue import find
from benchnav.testing.observations import briefings_of, observations_of
from benchnav.testing.scenes import USUAL, scene

LEARNED = ("recurrent-ppo", "recurrent-ppo-vo", "recurrent-ppo-plus", "q-learning")
HYBRIDS = ("recurrent-ppo-vo", "recurrent-ppo-plus")


def share(navigator, name, track, worlds):
    scenario = find(name)
    about = Assignment(
        scenario.identity, scenario.hash, "validation", track, "x", navigator, salt="00"
    )
    drawn = [(seed, build(scenario, "validation", seed)) for seed in range(worlds)]
    return np.mean([success(episode) for batch in rollout(about, drawn) for episode in batch])


def shown_the_way(name):
    """The navigator as it drives where a planner knows the way: without detours."""
    return {"type": name, "patience": 0} if name in HYBRIDS else name


def views(needs):
    """(briefings, observations) of a few decisions in two worlds."""
    worlds = [replace(scene(k, agents), sensing=USUAL) for k, agents in ((1, 3), (2, 5))]
    return briefings_of(worlds, needs), list(observations_of(worlds, needs))


@pytest.mark.parametrize("name", LEARNED)
def test_with_its_goal_for_a_target_it_is_the_navigator(name):
    navigator, controller = make(NAVIGATORS, shown_the_way(name)), make(CONTROLLERS, name)
    assert controller.required == navigator.required
    assert controller.command == navigator.command == "twist"
    assert controller.training == navigator.training
    assert controller.fingerprint == navigator.fingerprint
    told, seen = views(navigator.required)
    for part in (navigator, controller):
        part.reset(told, np.arange(2))
    for one in seen:
        offset = one.goal - one.position
        guide = Guide(one.goal, np.hypot(*np.moveaxis(offset, -1, 0)), one.active)
        np.testing.assert_array_equal(controller.steer(one, guide), navigator.act(one))


@pytest.mark.parametrize("name", LEARNED)
def test_a_target_near_the_goal_is_the_goal_and_another_is_not(name):
    controllers = [make(CONTROLLERS, name) for _ in range(3)]
    told, seen = views(controllers[0].required)
    one, answers = seen[0], []
    for controller, shift in zip(controllers, (0.0, 0.9, -40.0), strict=True):
        controller.reset(told, np.arange(2))
        target = one.goal + np.array([0.0, shift * told[0].goal_tolerance])
        answers.append(controller.steer(one, Guide(target, np.ones(one.active.shape), one.active)))
    np.testing.assert_array_equal(answers[0], answers[1])
    assert (answers[0] != answers[2]).any()


@pytest.mark.parametrize("name", LEARNED)
def test_a_waypoint_is_encoded_as_the_goal_while_rays_see_the_real_one(name, monkeypatch):
    controller = make(CONTROLLERS, name)
    told, seen = views(controller.required)
    one, shown = seen[0], []
    answer = np.zeros((*one.active.shape, 2))
    monkeypatch.setattr(controller.pilot, "twists", lambda *told: shown.append(told) or answer)
    controller.reset(told, np.arange(2))
    target = one.position + np.array([1.0, 0.5])
    controller.steer(one, Guide(target, np.ones(one.active.shape), one.active))
    view, tolerance = shown[0]
    near = np.hypot(*np.moveaxis(target - one.goal, -1, 0)) <= told[0].goal_tolerance
    np.testing.assert_array_equal(view.goal, np.where(near[..., None], one.goal, target))
    np.testing.assert_array_equal(tolerance > 0.0, near & one.active)
    assert view.rays is one.rays


def test_what_is_behind_a_waypoint_matters_to_foresight():
    """At full speed, 1 m before a wall: a goal before it excuses that, a waypoint does not."""
    from benchnav_baselines.learned.recurrent_ppo.foresight import foresee

    _, seen = views(frozenset({"neighbours", "edges"}))
    one = seen[0]
    wall = replace(
        one.edges,
        start=np.broadcast_to(
            one.position[..., None, :] + [1.0, 2.0], one.edges.start.shape
        ).copy(),
        end=np.broadcast_to(one.position[..., None, :] + [1.0, -2.0], one.edges.end.shape).copy(),
        count=np.ones_like(one.edges.count),
    )
    alone = replace(one.neighbours, count=np.zeros_like(one.neighbours.count))
    shape, half = one.active.shape, np.array([0.5, 0.0])
    view = replace(
        one, edges=wall, neighbours=alone, heading=np.zeros(shape), goal=one.position + half
    )
    bodies = Bodies(np.full(shape, 0.3), np.full(shape, 1.5), np.full(shape, 2.0))
    ahead = np.broadcast_to([1.5, 0.0], (*shape, 2)).copy()
    goal = foresee(view, bodies, ahead, np.full(shape, 0.4))
    waypoint = foresee(view, bodies, ahead, np.zeros(shape))
    assert (goal[one.active] == ahead[one.active]).all()
    assert (waypoint[one.active] != ahead[one.active]).any(axis=-1).all()


def test_a_pair_with_rays_that_the_weights_do_not_know_is_not_applicable():
    navigator = make(NAVIGATORS, "none+recurrent-ppo")
    other = replace(USUAL, rays=replace(USUAL.rays, count=9))
    assert "was made for 7 thick rays" in navigator.unfit(other)
    assert navigator.unfit(USUAL) == ""


@pytest.mark.parametrize("name", LEARNED)
def test_alone_as_a_controller_it_drives_like_the_navigator(name):
    scenario = find("leaders/static")
    world = [(0, build(scenario, "validation", 0))]
    end = []
    for spec in (shown_the_way(name), f"none+{name}"):
        about = Assignment(
            scenario.identity, scenario.hash, "validation", "unknown", "x", spec, salt="00"
        )
        end.append(next(batch[0] for batch in rollout(about, world)))
    np.testing.assert_array_equal(end[0].position, end[1].position)


@pytest.mark.slow
def test_a_plan_leads_a_policy_through_a_maze():
    assert share("recurrent-ppo-plus", "maze/grid", "known", 8) < 0.4
    assert share("visibility+recurrent-ppo-plus", "maze/grid", "known", 8) > 0.8
