"""ORCA where its assumptions hold, a learned policy elsewhere, on a path of a learned map."""

from dataclasses import replace

import numpy as np
import pytest
from benchnav_baselines.common.twist_conversion import CREEP, as_velocity
from benchnav_baselines.learned.recurrent_ppo import policy_at_work
from benchnav_baselines.learned.recurrent_ppo.controller import RecurrentPPOPlusController
from benchnav_baselines.learned.recurrent_ppo.policy_at_work import SHIPPED
from hypothesis import given
from hypothesis import strategies as st

from benchnav.arena.agents import Dynamics
from benchnav.arena.solid import Kind
from benchnav.generation.build import build
from benchnav.metrics.success import success
from benchnav.navigation.controller import Guide
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import CONTROLLERS, NAVIGATORS
from benchnav.runner.rollouts.rollout import Assignment, rollout
from benchnav.scenario.catalogue import find
from benchnav.testing.observations import briefings_of, observations_of
from benchnav.testing.scenes import USUAL, scene
from benchnav.world.dynamics import limited

ROWS = np.arange(2)
HYBRID = "map-orca-ppo"


def views(kind, **policy):
    """(controller, briefings, observations) in two worlds whose agents have one kind of body."""
    controller = make(CONTROLLERS, {"type": "orca-ppo", "policy": policy})
    worlds = []
    for k, agents in ((1, 3), (2, 5)):
        world = replace(scene(k, agents), sensing=USUAL)
        bodies = replace(world.agents, dynamics=np.full(agents, int(kind), np.int8))
        worlds.append(replace(world, agents=bodies))
    needs = controller.required
    return controller, briefings_of(worlds, needs), list(observations_of(worlds, needs))


def without_movers(one):
    """The view with its dynamic obstacles taken for agents."""
    kind = np.full_like(one.neighbours.kind, int(Kind.AGENT))
    return replace(one, neighbours=replace(one.neighbours, kind=kind))


def with_a_mover(one):
    """The view with everybody's nearest neighbour taken for a dynamic obstacle."""
    kind = np.full_like(one.neighbours.kind, int(Kind.AGENT))
    kind[..., 0] = int(Kind.DYNAMIC)
    count = np.maximum(one.neighbours.count, 1)
    return replace(one, neighbours=replace(one.neighbours, kind=kind, count=count))


def in_a_crowd(one):
    """Whether two agents or more are within 5 m of each agent (B, A); there are no movers."""
    crowded = np.zeros(one.active.shape, np.bool_)
    for b, a in np.argwhere(one.active):
        others = one.neighbours.position[b, a, : one.neighbours.count[b, a]]
        crowded[b, a] = sum(np.hypot(*(other - one.position[b, a])) < 5.0 for other in others) > 1
    return crowded


def alone(one):
    return replace(one, neighbours=replace(one.neighbours, count=np.zeros_like(one.active, int)))


def towards(one, target, more):
    """The guide to ``target`` on a path so many metres longer than the straight way to the goal."""
    straight = np.hypot(*np.moveaxis(one.goal - one.position, -1, 0))
    return Guide(target, straight + more, one.active)


def started(part, told):
    part.reset(told, ROWS)
    return part


def orca_of(controller):
    """Its ORCA alone, told by briefings with generators of their own."""
    spec = {"type": "orca", **controller.config.orca.model_dump()}
    return started(make(CONTROLLERS, spec), views(Dynamics.HOLONOMIC)[1])


def as_told(twist, one, told, kind):
    velocity = np.zeros_like(twist)
    body = np.full(one.active.shape, kind != Dynamics.HOLONOMIC)
    dt = np.full(one.active.shape, told[0].dt)
    as_velocity(one.active, body, one.heading, dt, twist, velocity)
    return velocity


def test_holonomic_bodies_on_detours_are_driven_by_orca_among_agents():
    controller, told, seen = views(Dynamics.HOLONOMIC)
    orca = orca_of(controller)
    started(controller, told)
    for one in map(without_movers, seen):
        guide = towards(one, one.position + 0.5, 0.6)
        given, wanted = controller.steer(one, guide), orca.steer(one, guide)
        np.testing.assert_array_equal(given[one.active], wanted[one.active])


@pytest.mark.parametrize("policy", [{}, {"weights": str(SHIPPED / "recurrent-ppo.safetensors")}])
def test_in_a_crowd_the_policy_drives_on_a_straight_way(policy, monkeypatch):
    """The second policy has an LSTM, whose state stays while ORCA drives."""
    monkeypatch.setattr(RecurrentPPOPlusController, "agents_behind", True)
    controller, told, seen = views(Dynamics.HOLONOMIC, **policy)
    orca = orca_of(controller)
    started(controller, told)
    policy = started(make(CONTROLLERS, {"type": "recurrent-ppo-plus", **policy}), told)
    crowded_once = alone_once = False
    for one in map(without_movers, seen):
        crowded = in_a_crowd(one)
        guide = towards(one, one.goal, 0.0)
        given, wanted = controller.steer(one, guide), orca.steer(one, guide)
        learned = replace(one, active=one.active & crowded)
        twist = as_told(policy.steer(learned, guide), learned, told, Dynamics.HOLONOMIC)
        for mask, expected in ((one.active & crowded, twist), (one.active & ~crowded, wanted)):
            np.testing.assert_array_equal(given[mask], expected[mask])
        crowded_once |= bool((one.active & crowded).any())
        alone_once |= bool((one.active & ~crowded).any())
    assert crowded_once
    assert alone_once


def test_agents_behind_are_predicted_too(monkeypatch):
    """`recurrent-ppo-plus` leaves them to its policy."""
    calls = []
    monkeypatch.setattr(
        policy_at_work, "without_agents_behind", lambda seen, _: calls.append(seen) or seen
    )
    controller, told, seen = views(Dynamics.UNICYCLE)
    plus = make(CONTROLLERS, "recurrent-ppo-plus")
    for one, expected in ((controller, 0), (plus, 1)):
        started(one, told).steer(seen[0], towards(seen[0], seen[0].goal, 0.0))
        assert len(calls) == expected


@pytest.mark.parametrize(("more", "goal"), [(0.0, True), (0.4, True), (0.6, False)])
@pytest.mark.parametrize("kind", [k for k in Dynamics if k != Dynamics.ACKERMANN])
def test_beside_movers_and_on_unicycles_the_policy_drives_and_sees_waypoints_on_detours(
    kind, more, goal
):
    controller, told, seen = views(kind)
    started(controller, told)
    policy = started(make(CONTROLLERS, "recurrent-ppo-plus"), told)
    for one in seen:
        view = with_a_mover(one) if kind == Dynamics.HOLONOMIC else without_movers(one)
        target = view.position + np.array([0.3, -0.8])
        given = controller.steer(view, towards(view, target, more))
        twist = policy.steer(view, towards(view, view.goal if goal else target, more))
        wanted = as_told(twist, one, told, kind)
        np.testing.assert_array_equal(given[one.active], wanted[one.active])


def test_a_mover_is_remembered_for_a_while():
    controller, told, seen = views(Dynamics.HOLONOMIC)
    orca = orca_of(controller)
    started(controller, told)
    one, memory = seen[0], controller.config.memory
    guide = towards(one, one.goal, 0.0)
    controller.steer(with_a_mover(one), guide)
    for time, policy_drives in ((memory - 0.1, True), (memory + 0.1, False)):
        later = replace(alone(one), time=np.full(2, time))
        same = controller.steer(later, guide) == orca.steer(later, guide)
        assert same[one.active].all() != policy_drives


def test_nothing_is_remembered_from_an_earlier_world():
    controller, told, seen = views(Dynamics.HOLONOMIC)
    one = seen[0]
    guide = towards(one, one.goal, 0.0)
    started(controller, told).steer(with_a_mover(one), guide)
    started(controller, views(Dynamics.HOLONOMIC)[1])
    given, wanted = (part.steer(alone(one), guide) for part in (controller, orca_of(controller)))
    np.testing.assert_array_equal(given[one.active], wanted[one.active])


@given(
    speed=st.floats(0.0, 3.0), rate=st.floats(-6.0, 6.0), heading=st.floats(-3.1, 3.1),
    dt=st.floats(0.05, 0.24),
)  # fmt: skip
def test_a_unicycle_that_tracks_the_velocity_does_what_the_twist_says(speed, rate, heading, dt):
    velocity = np.zeros((1, 1, 2))
    one = np.ones((1, 1))
    twist = np.array([[[speed, rate]]])
    as_velocity(one > 0, one > 0, heading * one, dt * one, twist, velocity)
    done = limited(*velocity[0, 0], False, True, heading, 3.0, 6.0, dt)
    assert done == pytest.approx((max(speed, CREEP), rate), abs=1e-6)


@given(speed=st.floats(0.1, 3.0), rate=st.floats(-6.0, 6.0), heading=st.floats(-3.1, 3.1))
def test_a_holonomic_body_drives_as_fast_where_it_will_face(speed, rate, heading):
    velocity = np.zeros((1, 1, 2))
    one = np.ones((1, 1))
    twist = np.array([[[speed, rate]]])
    as_velocity(one > 0, one > 1, heading * one, 0.2 * one, twist, velocity)
    angle = heading + 0.2 * rate
    assert velocity[0, 0] == pytest.approx((speed * np.cos(angle), speed * np.sin(angle)))


def test_it_is_the_pair_of_its_parts_and_declares_what_it_learned():
    hybrid, plus = make(NAVIGATORS, HYBRID), make(NAVIGATORS, "recurrent-ppo-plus")
    assert [part.name for part in hybrid.parts] == ["visibility", "orca-ppo"]
    assert hybrid.training == plus.training
    assert hybrid.fingerprint == plus.fingerprint
    assert "map" not in hybrid.required
    thin = replace(USUAL, rays=replace(USUAL.rays, thick=False))
    assert "maps with thick rays" in hybrid.unfit(thin)
    assert hybrid.unfit(USUAL) == ""
    slower = make(NAVIGATORS, {"type": HYBRID, "steering": {"orca": {"time_horizon": 7}}})
    assert slower.controller.config.orca.time_horizon == 7.0


def shares(navigator, name, worlds):
    scenario = find(name)
    about = Assignment(
        scenario.identity, scenario.hash, "validation", "unknown", "x", navigator, salt="00"
    )
    drawn = [(seed, build(scenario, "validation", seed)) for seed in range(worlds)]
    return np.mean([success(episode) for batch in rollout(about, drawn) for episode in batch])


def test_it_gets_out_of_a_trap_and_past_obstacles_that_never_yield():
    assert shares(HYBRID, "trap/u", 3) == 1.0
    assert shares("recurrent-ppo-plus", "trap/u", 10) < 0.6
    assert shares(HYBRID, "leaders/dynamic", 12) > 0.9
    assert shares("mapping+visibility+orca", "leaders/dynamic", 12) < 0.9


@pytest.mark.slow
def test_the_policy_follows_the_map_through_a_maze():
    scenario = find("maze/grid")
    drawn = []
    for seed in range(4):
        world = build(scenario, "validation", seed)
        bodies = np.full(len(world.agents), int(Dynamics.UNICYCLE), np.int8)
        drawn.append((seed, replace(world, agents=replace(world.agents, dynamics=bodies))))
    about = Assignment(
        scenario.identity, scenario.hash, "validation", "unknown", "x", HYBRID, salt="00"
    )
    found = [success(episode) for batch in rollout(about, drawn) for episode in batch]
    assert np.mean(found) > 0.8
