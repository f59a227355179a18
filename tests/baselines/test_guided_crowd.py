"""The guided crowd follows what its leaders rehearsed, and says what is wrong with it."""

import json
import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from benchnav_baselines.navigators.guided_crowd.group import (
    groups_of,
    places_in_corridor,
    turn_offs,
)
from benchnav_baselines.navigators.guided_crowd.guiding_path import (
    GuidingPath,
    arc_length,
    best_path,
    simplified,
    turning,
)
from benchnav_baselines.navigators.guided_crowd.march import advanced, aim, at, clear, direction
from benchnav_baselines.navigators.guided_crowd.path_file import read_paths, write_paths
from benchnav_baselines.navigators.guided_crowd.recorded import draw_paths, paths_of
from hypothesis import given, settings
from hypothesis import strategies as st

from benchnav.arena.agents import Role
from benchnav.arena.solid import Kind
from benchnav.errors import ConfigError, InputError
from benchnav.navigation.plugin.configure import make
from benchnav.navigation.rehearsal import Rehearsal
from benchnav.plugins import NAVIGATORS
from benchnav.runner.plan.suite import load_suite
from benchnav.runner.rollouts.recorder import Recorder
from benchnav.runner.rollouts.rehearsal import perform
from benchnav.runner.rollouts.rollout import Assignment, drive, drivers_of
from benchnav.world.simulation import Simulation
from tests import worlds
from tests.baselines.crowds import briefing
from tests.reference import march as slow

DT = 0.2
DETOUR = np.array([(2.0, 10.0), (6.0, 15.0), (14.0, 15.0), (18.0, 10.0)])


def walked(points, speed=2.0):
    """(T+1, 2) positions of somebody who walks a polyline at a speed."""
    arc = arc_length(points)
    s = np.append(np.arange(0.0, arc[-1], speed * DT), arc[-1])
    return np.stack([np.interp(s, arc, points[:, k]) for k in (0, 1)], axis=1)


def rehearsal(points, arrival, collided=False, agent=0):
    way = walked(np.asarray(points, float))
    return Rehearsal(
        DT, np.array([agent]), way[:, None], np.array([len(way) - 1]), np.array([arrival]),
        np.array([collided]),
    )  # fmt: skip


def path(points):
    return GuidingPath(np.asarray(points, float), 1.0, 0.0, 0.5, 1, 1)


def group(members, start=None, goal=None, radius=0.25, leader_goal=(18.0, 10.0)):
    """A leader at (2, 10) and followers behind it, who want to its other side."""
    if start is None:
        start = [(1.0 + 0.0 * k, 10.0 + 0.7 * (k - (members - 1) / 2)) for k in range(members)]
    goal = [(18.0, y) for _, y in start] if goal is None else goal
    crew = worlds.agents([(2.0, 10.0), *start], [leader_goal, *goal], radius=radius, speed=1.5)
    role = np.array([int(Role.LEADER), *[int(Role.FOLLOWER)] * members], np.int8)
    return replace(crew, role=role)


def run(world, rehearsals=(), decisions=None, **parameters):
    """Positions (T+1, A, 2) and the navigator after an episode with these rehearsals."""
    spec = {"type": "guided-crowd", "leader": "orca", **parameters}
    assignment = Assignment("x@1", "0" * 16, "test", "unknown", "g", spec, salt="5a")
    simulation = Simulation([world])
    recorder = Recorder(simulation)
    recorder.record_state()
    drivers = drivers_of(assignment, simulation, [tuple(rehearsals)])
    drive(assignment, drivers, recorder, [0], decisions)
    navigator = drivers[0].navigator
    (episode,) = recorder.episodes([assignment.identity(0)], 0.0, "", True, [()])
    return episode, navigator


def arrived(episode):
    return episode.status[-1] == 1


# the choice of the path


def test_the_fastest_without_a_collision_becomes_the_path():
    straight = [(0.0, 0.0), (8.0, 0.0)]
    tried = [
        rehearsal([(0, 0), (4, 1), (8, 0)], 4.0), rehearsal(straight, 3.0, collided=True),
        rehearsal([(0, 0), (4, -1), (8, 0)], 3.5), rehearsal(straight, math.nan),
    ]  # fmt: skip
    best = best_path(tried, 0, 0.5, 0.01)
    assert best.points.tolist() == [[0.0, 0.0], [4.0, -1.0], [8.0, 0.0]] or best.points[1, 1] < 0
    assert (best.duration, best.rehearsals, best.succeeded) == (3.5, 4, 2)


def test_ties_go_to_the_smoothest_then_to_the_first():
    zigzag = [(0, 0), (2, 1), (4, -1), (6, 1), (8, 0)]
    up, down = [(0, 0), (4, 1), (8, 0)], [(0, 0), (4, -1), (8, 0)]
    chosen = best_path([rehearsal(w, 4.0) for w in (zigzag, up, down)], 0, 0.5, 0.01)
    assert chosen.points[:, 1].max() == pytest.approx(1.0, abs=0.2)
    assert chosen.turning < turning(walked(np.array(zigzag, float)))


def test_a_leader_that_never_succeeds_has_no_path_unless_a_hit_is_allowed():
    tried = [rehearsal([(0, 0), (5, 0)], 3.0, collided=True), rehearsal([(0, 0), (1, 0)], math.nan)]
    assert best_path(tried, 0, 0.5, 0.01) is None
    assert best_path(tried, 0, 0.5, 0.01, hits=True).succeeded == 0
    assert best_path(tried[1:], 0, 0.5, 0.01, hits=True) is None


def test_turning_of_a_circle_is_a_full_turn_however_it_is_sampled():
    for count in (40, 400):
        angle = np.linspace(0.0, 2 * np.pi, count)
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        assert turning(circle) == pytest.approx(2 * np.pi, rel=0.06)
    assert turning(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [3.0, 0.0]])) == 0.0


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10_000), st.floats(0.01, 0.5))
def test_a_simplified_path_stays_near_and_keeps_its_ends(seed, tolerance):
    way = np.cumsum(np.random.default_rng(seed).normal(size=(60, 2)) * 0.3, axis=0)
    kept = simplified(way, tolerance)
    assert kept[[0, -1]].tolist() == way[[0, -1]].tolist()
    places = [np.flatnonzero((way == point).all(axis=1))[0] for point in kept]
    for first, last in pairwise(places):
        for point in way[first : last + 1]:
            assert slow._distance(point[None], way[first], way[last])[0] <= tolerance + 1e-9


# the file


def test_a_file_gives_the_same_path_back(tmp_path):
    paths = [path(np.random.default_rng(3).normal(size=(7, 2))), path([(0, 0), (1 / 3, 2)])]
    write_paths(tmp_path / "p.json", paths)
    back = read_paths(tmp_path / "p.json")
    for left, right in zip(paths, back, strict=True):
        assert left.points.tobytes() == right.points.tobytes()
        assert (left.duration, left.rehearsals) == (right.duration, right.rehearsals)
    assert json.loads((tmp_path / "p.json").read_text())["version"] == 1


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (None, "No such file"),
        ("{", "EOF"),
        ('{"format": "other", "version": 1, "paths": []}', "format"),
        ('{"format": "benchnav guiding paths", "version": 1, "paths": []}', "paths"),
        ('{"format": "benchnav guiding paths", "version": 1, "paths": [{"points": [[0, 0]]}]}',
         "points"),
        ('{"format": "benchnav guiding paths", "version": 1, "paths": [{"points": [[0, 0], [0, 0]]'
         "}]}", "different points"),
    ],
)  # fmt: skip
def test_a_file_that_holds_something_else_is_refused_with_the_place(tmp_path, text, why):
    file = tmp_path / "p.json"
    if text is not None:
        file.write_text(text)
    with pytest.raises(InputError, match=r"must be a file of guiding paths") as refused:
        make(NAVIGATORS, {"type": "guided-crowd", "path": str(file)})
    assert why in str(refused.value)


def test_parameters_are_checked():
    with pytest.raises(ConfigError, match="rehearsal"):
        make(NAVIGATORS, {"type": "guided-crowd", "rehearsal": 0})


# the kernels and their twins


def random_way(seed):
    rng = np.random.default_rng(seed)
    return rng, np.cumsum(rng.normal(size=(9, 2)), axis=0)


@pytest.mark.parametrize("seed", range(30))
def test_progress_is_the_nearest_place_within_reach(seed):
    rng, way = random_way(seed)
    low = rng.uniform(0.0, 4.0)
    high, place = low + rng.uniform(0.5, 4.0), way[4] + rng.normal(size=2)
    got = advanced(way, arc_length(way), low, high, *place)
    twin = slow.advanced(way, low, high, place)
    points, s = slow.sampled(way)
    away = [np.hypot(*(points[np.argmin(np.abs(s - x))] - place)) for x in (got, twin)]
    assert low - 1e-9 <= got <= high + 1e-9
    assert away[0] == pytest.approx(away[1], abs=3e-3)


@pytest.mark.parametrize("seed", range(10))
def test_points_and_directions_of_a_path(seed):
    rng, way = random_way(seed)
    arc = arc_length(way)
    points, s = slow.sampled(way)
    for wanted in rng.uniform(-1.0, arc[-1] + 1.0, 20):
        near = points[np.argmin(np.abs(s - np.clip(wanted, 0.0, arc[-1])))]
        assert np.hypot(*(np.array(at(way, arc, wanted)) - near)) < 2e-3
        assert np.hypot(*direction(way, arc, wanted, 0.7)) == pytest.approx(1.0)


@pytest.mark.parametrize("seed", range(60))
def test_clear_is_what_a_disc_touches_that_it_did_not_touch_before(seed):
    rng = np.random.default_rng(seed)
    edges = rng.uniform(-3, 3, (4, 2, 2))
    a, b, radius = rng.uniform(-3, 3, 2), rng.uniform(-3, 3, 2), 0.4
    touched, before, nearer = slow.touches(edges, a, b, radius)
    expected = not (np.where(before, nearer, touched)).any()
    got = clear(edges[:, 0].copy(), edges[:, 1].copy(), 4, *a, *b, radius)
    margin = (
        slow.touches(edges, a, b, radius + 0.01)[0],
        slow.touches(edges, a, b, radius - 0.01)[0],
    )
    if (margin[0] == margin[1]).all() and not before.any():
        assert got == expected


# groups and corridors


def told(team, role, start, goal):
    plain = briefing(np.array(start, float), np.array(goal, float))
    return replace(plain, team=np.array(team), role=np.array(role, np.int8))


def test_members_follow_the_leader_of_their_team_that_is_nearest():
    brief = told(
        [0, 0, 0, 0, 1, 2], [0, 0, 1, 1, 0, 1],
        [(0, 0), (9, 0), (1, 0), (8, 0), (1, 1), (0, 1)],
        [(0, 9), (9, 9), (1, 9), (8, 9), (1, 9), (0, 9)],
    )  # fmt: skip
    found = {g.leader: g.members.tolist() for g in groups_of(brief, np.array([0, 1, 4]))}
    assert found == {0: [0, 2], 1: [1, 3], 4: [4]}


def test_places_in_the_corridor_keep_the_order_within_its_width():
    east = path([(0, 0), (20, 0)])
    start = np.array([(-1.0, y) for y in (-8.0, -2.0, 0.0, 4.0)])
    assert places_in_corridor(east, start, 10.0).tolist() == [-8.0, -2.0, 0.0, 4.0]
    assert places_in_corridor(east, start, 2.0).tolist() == [-2.0, -0.5, 0.0, 1.0]
    assert places_in_corridor(east, start, 0.0).tolist() == [0.0] * 4


def test_members_leave_the_path_where_it_comes_nearest_to_their_goal():
    hairpin = path([(0, 0), (20, 0), (20, 4), (0, 4)])
    goal = np.array([(0.0, 4.0), (5.0, 4.5), (3.0, 2.0)])
    found = turn_offs(hairpin, goal, 1.0)
    assert found.tolist() == pytest.approx([43.0, 38.0, 40.0])  # not where it passed by before


# whole episodes


def test_a_group_takes_its_leaders_detour_in_a_corridor():
    world = worlds.world(group(9), side=20.0)
    episode, navigator = run(world, [rehearsal(DETOUR, 9.0)], spread=2.0)
    assert arrived(episode).all()
    assert navigator.remarks(0) == []
    middle = episode.position[:, :, 0] > 9.5
    height = np.array([episode.position[np.argmax(middle[:, a]), a, 1] for a in range(10)])
    assert (np.abs(height - 15.0) < 2.5).all()
    assert np.ptp(height) > 2.0  # spread over the corridor, in the order of the start
    assert np.corrcoef(height[1:], episode.position[0, 1:, 1])[0, 1] > 0.8
    straight, _ = run(world, [])
    assert np.abs(straight.position[..., 1] - 10.0).max() < 4.0


@pytest.mark.parametrize("members", [0, 1, 99])
def test_groups_of_any_size(members):
    start = [(0.6 + 0.7 * (k % 2), 10.0 + 0.6 * (k // 2 - members / 4)) for k in range(members)]
    goal = [(19.0 - x, y) for x, y in start]
    world = worlds.world(group(members, start, goal), side=40.0)
    episode, _ = run(world, [rehearsal(DETOUR, 9.0)])
    assert arrived(episode).mean() > 0.98  # the horizon is short for who is pushed past its goal


def test_a_thousand_members_are_driven():
    start = [(1.0 - 0.9 * (k // 20), 10.0 + 0.9 * (k % 20 - 9.5)) for k in range(999)]
    world = worlds.world(group(999, start, [(x + 16, y) for x, y in start]), side=60.0)
    episode, _ = run(world, [rehearsal(DETOUR, 9.0)], decisions=40, spread=9.0)
    moved = np.hypot(*(episode.position[-1] - episode.position[0]).T)
    assert len(moved) == 1000
    assert np.median(moved) > 3.0


def test_nobody_stands_still_where_the_corridor_folds():
    way = np.array([(0.0, 0.0), (8.0, 0.0), (12.0, -5.0)])
    arc, edges = arc_length(way), np.zeros((1, 2))
    place, here = np.array([4.0, -3.0]), 4.0
    for _ in range(200):
        here = advanced(way, arc, here, here + 4.0, *place)
        if here > arc[-1] - 1.0:
            return
        goal = aim(way, arc, here, *place, 0.25, -3.0, 3.0, 2.0, edges, edges, 0)
        offset = np.array(goal) - place
        place += offset * min(1.0, 0.1 / np.hypot(*offset))
    raise AssertionError(f"it stands at {place} with {arc[-1] - here} m left")


def test_collisions_are_avoided_before_the_path_is_followed():
    mover = worlds.back_and_forth(worlds.disc(Kind.DYNAMIC, 0, 0, 0.5), (10, 13), (10, 17), 1.0)
    episode, _ = run(worlds.world(group(5), bodies=[mover]), [rehearsal(DETOUR, 9.0)])
    assert arrived(episode).all()
    assert len(episode.contacts) == 0


def test_an_obstacle_that_came_onto_the_path_is_told_and_walked_round():
    box = worlds.box(Kind.STATIC, 10.0, 15.0, 0.6, 0.6)
    episode, navigator = run(worlds.world(group(6), [box]), [rehearsal(DETOUR, 9.0)], spread=1.0)
    (remark,) = navigator.remarks(0)
    assert remark.startswith("an obstacle is on the guiding path of team 0 that was not there")
    assert arrived(episode).all()


def test_goals_behind_a_wall_are_told():
    wall = worlds.box(Kind.STATIC, 18.0, 12.0, 1.9, 0.2)
    start = [(1.0, 9.5), (1.0, 10.5)]
    world = worlds.world(group(2, start, [(18.0, 13.5), (17.5, 10.0)]), [wall], steps=120)
    _, navigator = run(world, [rehearsal([(2, 10), (18, 10)], 9.0)])
    (remark,) = navigator.remarks(0)
    assert "between the guiding path's end and the goals of 1 of team 0" in remark


def test_without_a_success_the_group_goes_straight_and_says_why():
    hit, late = rehearsal(DETOUR, 9.0, collided=True), rehearsal(DETOUR[:2], math.nan)
    world = worlds.world(group(3))
    episode, navigator = run(world, [hit, late])
    assert navigator.remarks(0) == [
        "the leader of team 0 succeeded in none of 2 rehearsals (1 with a collision, 1 not"
        " arrived): its group goes straight to its goals"
    ]
    assert np.abs(episode.position[..., 1] - 10.0).max() < 3.0
    assert arrived(episode).all()
    episode, navigator = run(world, [hit, late], fallback="collided")
    assert "its group follows a trajectory with a collision" in navigator.remarks(0)[0]
    assert episode.position[..., 1].max() > 14.0


def test_a_file_comes_before_the_rehearsals_where_it_fits(tmp_path):
    write_paths(tmp_path / "p.json", [path([(50, 50), (60, 60)]), path(DETOUR * (1, -1) + (0, 20))])
    world = worlds.world(group(3))
    given = {"path": str(tmp_path / "p.json")}
    episode, navigator = run(world, [rehearsal(DETOUR, 9.0)], **given)
    assert episode.position[..., 1].min() < 6.0
    assert navigator.remarks(0) == []
    write_paths(tmp_path / "p.json", [path([(2, 10), (10, 15)])])
    episode, navigator = run(world, [rehearsal(DETOUR, 9.0)], **given)
    assert episode.position[..., 1].max() > 14.0
    (remark,) = navigator.remarks(0)
    assert remark.endswith("the nearest begins 0.0 m and ends 9.4 m away")


def test_the_file_is_part_of_what_an_entry_is(tmp_path):
    write_paths(tmp_path / "p.json", [path(DETOUR)])
    spec = {"type": "guided-crowd", "path": str(tmp_path / "p.json")}
    first = make(NAVIGATORS, spec).fingerprint
    write_paths(tmp_path / "p.json", [path(DETOUR + 1.0)])
    assert "" != first != make(NAVIGATORS, spec).fingerprint
    assert make(NAVIGATORS, "guided-crowd").fingerprint == ""


def test_its_entry_learned_what_its_leader_learned(tmp_path):
    leaders = ("recurrent-ppo", "orca")
    asked = [f"{{type: guided-crowd, leader: {who}, label: {who}}}" for who in leaders]
    path = tmp_path / "s.yaml"
    path.write_text(f"name: s\nscenarios: [groups/crossing]\nnavigators: [{', '.join(asked)}]\n")
    learned, planned = load_suite(str(path)).contestants
    assert learned.training == make(NAVIGATORS, "recurrent-ppo").training is not None
    assert planned.training is None


def performed(world, **parameters):
    spec = {"type": "guided-crowd", "leader": "orca", "rehearsal": 2, **parameters}
    assignment = Assignment(
        "x@1", "0" * 16, "test", "unknown", "g", spec, salt="5a", rehearsals=2, leader="orca"
    )
    ((performance,),) = perform(assignment, [(0, world)])
    return performance


def test_by_the_runner_from_rehearsal_to_picture(tmp_path):
    box = worlds.box(Kind.STATIC, 10.0, 10.6, 1.0, 0.5)
    mover = worlds.back_and_forth(worlds.disc(Kind.DYNAMIC, 0, 0, 0.3), (14, 8), (14, 12), 1.0)
    world = worlds.world(group(6), [worlds.walls(20.0), box], [mover])
    done = performed(world)
    assert (done.episode.rehearsals, len(done.rehearsed.episodes)) == (2, 2)
    assert done.episode.remarks == ()
    assert arrived(done.episode).all()
    (found,) = paths_of(done.rehearsed.episodes)
    assert found.rehearsals == 2
    assert found.points[0].tolist() == [2.0, 10.0]
    assert np.hypot(*(found.points[-1] - (18.0, 10.0))) <= 0.3 + 0.2
    write_paths(tmp_path / "p.json", [found])
    again = performed(world, path=str(tmp_path / "p.json"))
    assert again.episode.digest == done.episode.digest


def test_a_picture_is_drawn():
    figure = pytest.importorskip("matplotlib.figure").Figure()
    axes = figure.subplots()
    box = worlds.box(Kind.STATIC, 10.0, 10.3, 1.0, 0.5)
    world = worlds.world(group(1), [worlds.walls(20.0), box, worlds.disc(Kind.STATIC, 5, 5, 1)])
    draw_paths([path(DETOUR)], axes, world)
    assert len(axes.lines) == 2
    assert len(axes.patches) == 3
