import math
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from benchnav_baselines.controllers.social_force.controller import SocialForce
from benchnav_baselines.controllers.social_groups.controller import SocialGroups
from benchnav_baselines.controllers.social_groups.groups import (
    companions_of,
    draw_changes,
    form_groups,
    standing,
)
from benchnav_baselines.controllers.social_groups.kernel import (
    GroupForces,
    group_force,
    head_turn,
)
from hypothesis import given
from hypothesis import strategies as st

import benchnav
from benchnav.errors import ConfigError
from benchnav.navigation.controller import Guide
from tests.baselines.crowds import briefing, joined, keyed, one_world, permuted

PAPER = GroupForces(
    gaze=4.0, attraction=3.0, repulsion=1.0, view_angle=0.5 * math.pi, spacing=1.0, ramp=0.5,
    distance=0.8,
)  # fmt: skip
PAIRS = (0.0, 1.0)


def steer(controller, seen, told, target):
    controller.reset(told, seen.rows)
    has_path = np.ones(target.shape[:2], bool)
    return controller.steer(seen, Guide(target, np.full(target.shape[:2], 3.0), has_path))


def groups_with(**parameters):
    return SocialGroups(SocialGroups.Config(**parameters))


def forces_on(position, velocity, companions, active=None, forces=PAPER):
    """Accelerations (A, 2) of the agents of one world."""
    agents = len(position)
    active = np.ones(agents, bool) if active is None else active
    answer = np.zeros((agents, 2))
    group_force(0, agents, agents, active, position, velocity, companions, forces, answer)
    return answer


def slow_force(i, group, position, velocity, p=PAPER):
    """The twin for one member, on vectors and angles."""
    others = [k for k in group if k != i]
    force = np.zeros(2)
    for k in others:
        away = position[i] - position[k]
        if np.hypot(*away) < p.distance:
            force += p.repulsion * away / np.hypot(*away)
    middle = position[[i, *others]].mean(0) - position[i]
    difference = np.angle(complex(*middle) / complex(*velocity[i]))
    turn = max(abs(difference) - p.view_angle, 0.0)
    share = np.clip((np.hypot(*middle) - p.spacing * (len(group) - 1) / 2) / p.ramp, 0, 1)
    return force - p.gaze * turn * velocity[i] + p.attraction * share * middle / np.hypot(*middle)


@pytest.mark.parametrize("seed", range(5))
def test_forces_equal_their_slow_twin_and_ignore_inactive_members(seed):
    rng = np.random.default_rng(seed)
    position, velocity = rng.normal(0, 1, (9, 2)), rng.normal(0, 1, (9, 2))
    groups = [np.array([0, 3, 5, 8]), np.array([1, 2]), np.array([4, 6]), np.array([7])]
    active = np.ones(9, bool)
    active[[5, 6]] = False
    got = forces_on(position, velocity, companions_of(groups, 9, 3), active)
    for group in groups:
        left = [int(k) for k in group if active[k]]
        for i in group:
            alone = len(left) < 2 or not active[i]
            expected = np.zeros(2) if alone else slow_force(i, left, position, velocity)
            np.testing.assert_allclose(got[i], expected, atol=1e-12)


def test_the_head_turns_only_to_what_is_behind():
    for degrees, expected in ((0, 0), (89, 0), (91, 1), (-135, 45), (180, 90)):
        angle = math.radians(degrees)
        turn = head_turn(2.0, 0.0, 3 * math.cos(angle), 3 * math.sin(angle), 0.5 * math.pi)
        assert math.degrees(turn) == pytest.approx(expected, abs=1e-9)


def test_forces_of_the_paper_in_configurations_computed_by_hand():
    pair, ahead = np.array([[2], [1]]), np.array([[1.0, 0.0], [1.0, 0.0]])
    # side by side 1 m apart: the centre is 0.5 m = (N − 1) / 2 off, and nobody turns the head
    beside = forces_on(np.array([[0.0, 0.5], [0.0, -0.5]]), ahead, pair)
    np.testing.assert_array_equal(beside, np.zeros((2, 2)))
    # 0.6 m apart: they repel each other
    near = forces_on(np.array([[0.0, 0.3], [0.0, -0.3]]), ahead, pair)
    np.testing.assert_array_equal(near, [(0.0, 1.0), (0.0, -1.0)])
    # 4 m behind each other: full attraction, and the first turns its head by 90°
    behind = forces_on(np.array([[4.0, 0.0], [0.0, 0.0]]), ahead, pair)
    np.testing.assert_allclose(behind, [(-3.0 - 4.0 * math.pi / 2, 0.0), (3.0, 0.0)])
    # in one place there is no direction
    assert not forces_on(np.zeros((2, 2)), ahead, pair).any()


def test_sizes_follow_their_shares():
    place = np.random.default_rng(1).uniform(0, 1, (3000, 2))
    groups = form_groups(briefing(place, place), (0.5, 0.3, 0.2), 3.0)
    count = Counter(len(group) for group in groups)
    for size, share in ((1, 0.5), (2, 0.3), (3, 0.2)):
        assert count[size] / len(groups) == pytest.approx(share, abs=0.04)
    assert sum(map(len, groups)) == 3000


@given(
    seed=st.integers(0, 10**6), agents=st.integers(1, 30), reach=st.floats(0.1, 5.0),
    shares=st.lists(st.floats(0.01, 1.0), min_size=1, max_size=5),
)  # fmt: skip
def test_groups_are_of_one_team_near_each_other_and_independent_of_numbers(
    seed, agents, reach, shares
):
    rng = np.random.default_rng(seed)
    start, goal = rng.uniform(0, 5, (2, agents, 2))
    told = replace(briefing(start, goal), team=rng.integers(0, 2, agents))
    groups = form_groups(told, shares, reach)
    assert sorted(np.concatenate(groups)) == list(range(agents))
    for group in groups:
        assert len(group) <= len(shares)
        assert len(set(told.team[group])) == 1
        center = min(
            max(np.hypot(*(x[group] - x[k]).T).max() for x in (start, goal)) for k in group
        )
        assert center <= reach
    order = rng.permutation(agents)
    other = replace(told, start=start[order], goal=goal[order], team=told.team[order], rng=keyed(0))
    again = form_groups(other, shares, reach)
    assert {frozenset(order[g].tolist()) for g in again} == {frozenset(g.tolist()) for g in groups}


def test_alone_people_walk_as_in_the_social_force_model():
    told, seen = one_world(0, 7)
    target = seen.goal
    alone = steer(groups_with(group_sizes=(1.0,)), seen, [told], target)
    fresh = replace(told, rng=keyed(0))
    np.testing.assert_array_equal(alone, steer(SocialForce(), seen, [fresh], target))


def test_neither_batch_nor_numbers_matter():
    settings = {"group_sizes": (0.2, 0.5, 0.3), "group_reach": 9.0, "stop_every": 1.0}
    told, seen = zip(*(one_world(w, 7) for w in range(3)), strict=True)
    seen = [replace(s, time=np.full(1, 2.0)) for s in seen]
    batch = joined(seen)
    together = steer(groups_with(**settings), batch, told, batch.goal)
    order = np.random.default_rng(1).permutation(7)
    for w in range(3):
        fresh = replace(told[w], rng=keyed(w))
        alone = steer(groups_with(**settings), seen[w], [fresh], seen[w].goal)
        np.testing.assert_array_equal(alone[0], together[w])
        other, view = permuted(replace(told[w], rng=keyed(w)), seen[w], order)
        mixed = steer(groups_with(**settings), view, [other], view.goal)
        np.testing.assert_array_equal(mixed[0], together[w][order])


def test_a_group_prefers_the_mean_speed_of_its_members():
    told = briefing([(0, 0), (0, 1)], [(50, 0), (50, 1)])
    told = replace(told, preferred_speed=np.array([0.8, 1.4]))
    _, seen = one_world(0, 2)
    settings = {"group_sizes": PAIRS, "fluctuation": 0.0, "pedestrians": 0.0}
    velocity = np.zeros((1, 2, 2))
    for _ in range(30):
        seen = replace(
            seen, position=told.start[None], velocity=velocity, neighbours=None, edges=None
        )
        fresh = replace(told, rng=keyed(0))
        velocity = steer(groups_with(**settings), seen, [fresh], told.goal[None])
    np.testing.assert_allclose(velocity[0], [(1.1, 0), (1.1, 0)], atol=1e-4)


def test_stops_begin_and_end_as_often_and_last_as_long_as_asked():
    changes = np.array([draw_changes(30.0, 10.0, keyed(w)) for w in range(400)])
    assert (np.diff(changes, axis=1) >= 0).all()
    spans = np.diff(changes, axis=1, prepend=0.0)
    assert spans[:, ::2].mean() == pytest.approx(30.0, rel=0.05)
    assert spans[:, 1::2].mean() == pytest.approx(10.0, rel=0.05)
    stands = [standing(changes[None], np.array([t])).mean() for t in (0.0, 100.0, 150.0, 200.0)]
    assert stands[0] == 0.0
    assert np.mean(stands[1:]) == pytest.approx(0.25, abs=0.05)
    edges = (
        standing(changes[None, :1], changes[0, :1])[0, 0],
        standing(changes[None, :1], changes[0, 1:2])[0, 0],
    )
    assert edges == (True, False)


WALKWAY = """\
name: tests/walkway
bounds: [-14, -8, 40, 8]
teams:
  - name: robot
    radius: 0.2
    max_speed: 0.1
    start: {type: points, points: [[35, 7.5]]}
    goal: {type: points, points: [[39, 7.5]]}
  - name: pairs
    count: 16
    radius: 0.23
    max_speed: 2.5
    preferred_speed: {normal: [1.34, 0.26, 0.7, 1.9]}
    start: {type: points, points: POINTS}
    goal: {type: shifted, by: [40, 0]}
    driver: {type: none+social-groups, controller: CONTROLLER}
    ignores: [robot]
  - name: oncoming
    count: 40
    radius: 0.23
    max_speed: 2.5
    start: {type: region, region: {type: rectangle, bounds: [3, -7, 25, 7]}, separation: 0.2}
    goal: {type: shifted, by: [-16, 0]}
    driver: none+social-force
clock: {dt: 0.1, substeps: 1, horizon: 15}
"""
POINTS = [[x, y + side] for x in (-10, -4) for y in (-6, -2, 2, 6) for side in (-0.5, 0.5)]


@pytest.fixture(scope="module")
def walked(tmp_path_factory):
    """Positions (T+1, 16, 2) of eight pairs who walk through a stream, by their parameters."""
    folder = tmp_path_factory.mktemp("walkway")

    def walk(parameters):
        file = folder / "walkway.yaml"
        text = WALKWAY.replace("CONTROLLER", parameters).replace("POINTS", str(POINTS))
        file.write_text(text)
        world = benchnav.load_scenario(file).world(seed=0)
        record = benchnav.simulate(world, "straight-line").record
        return record.position[:, record.world.agents.team == 1]

    return walk


def test_groups_keep_together_and_without_their_forces_do_not(walked):
    def apart(parameters):
        offset = np.diff(walked(parameters).reshape(-1, 8, 2, 2), axis=2)
        return float(np.mean(np.hypot(*np.moveaxis(offset[-50:], -1, 0))))

    together = apart("{group_sizes: [0, 1], group_reach: 1.5}")
    assert together < 1.5
    none = "gaze: 0, attraction: 0, repulsion: 0"
    assert apart(f"{{group_sizes: [0, 1], group_reach: 1.5, {none}}}") > 1.5 * together
    assert apart("{group_sizes: [1]}") > 2.0 * together


def test_people_stand_and_go_on(walked):
    place = walked("{group_sizes: [0, 1], group_reach: 1.5, stop_every: 4, stop_for: 4}")[::10]
    stands = np.hypot(*np.moveaxis(np.diff(place, axis=0), -1, 0)) < 0.25  # (15, 16) in a second
    assert 0.2 < stands[3:].mean() < 0.7
    assert (stands[:-1] & ~stands[1:]).any(axis=0).sum() > 4  # go on
    pairs = stands.reshape(-1, 8, 2)
    assert (pairs[..., 0] == pairs[..., 1]).mean() > 0.8


def test_wrong_parameters_are_refused():
    for shares in ([], [0, 0], [0.5, -0.1], [0.1] * 13):
        with pytest.raises(ConfigError, match="group_sizes"):
            benchnav.simulate(
                benchnav.load_scenario("trap/u").world(seed=0),
                {"type": "none+social-groups", "controller": {"group_sizes": shares}},
            )
