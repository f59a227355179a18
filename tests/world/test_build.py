"""Worlds: pure, disjoint between splits, free of overlaps, and solvable."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchnav.arena.body import LawKind
from benchnav.arena.solid import Kind
from benchnav.config.yaml_reader import read_yaml_text
from benchnav.errors import InputError, ScenarioError, UnsolvableError, UsageError
from benchnav.generation import prepared
from benchnav.generation.build import build
from benchnav.generation.clearance import barrier, clear
from benchnav.generation.motion_law import place_at_start, swept
from benchnav.generation.world_digest import coincidences, is_random, world_digest
from benchnav.scenario.catalogue import find
from benchnav.scenario.load import load_scenario, scenario_from_text
from benchnav.scenario.terms import SPLITS, TRACKS
from tests.reference import clearance as slow
from tests.scenario.files import SHIPPED, SMALL
from tests.scenario.mutations import mutate, text_of

NAMES = [f"{path.parent.name}/{path.stem}" for path in SHIPPED]
SCENARIOS = dict(zip(NAMES, map(load_scenario, SHIPPED), strict=True))


def scenario(text=SMALL):
    return scenario_from_text(text, "s.yaml")


def starting_solids(world):
    """Everything static as it stands at t = 0."""
    return [*world.solids, *(b.solid.moved(b.law.points[0]) for b in relocating(world))]


def ending_solids(world):
    return [*world.solids, *(b.solid.moved(b.law.points[1]) for b in relocating(world))]


def relocating(world):
    return [body for body in world.bodies if body.law.kind == LawKind.RELOCATE]


def moving(world):
    return [body for body in world.bodies if body.law.kind != LawKind.RELOCATE]


@pytest.mark.parametrize("name", NAMES)
def test_shipped_worlds_are_free_of_overlaps(name):
    for seed in range(20):
        world = build(SCENARIOS[name], "test", seed)
        agents = world.agents
        assert len(agents) >= 1
        assert world.redraws < 20
        static = starting_solids(world)
        assert np.all(slow.clearances(agents.start, static) > agents.radius)
        for arrangement in (static, ending_solids(world)):
            assert np.all(slow.clearances(agents.goal, arrangement) > agents.radius)
        bodies = [body.solid.moved(place_at_start(body.law)) for body in moving(world)]
        assert np.all(slow.clearances(agents.start, bodies) > agents.radius)
        reach = agents.radius[:, None] + agents.radius
        for places in (agents.start, agents.goal):
            apart = np.linalg.norm(places[:, None] - places, axis=2)
            assert np.all((apart > reach)[~np.eye(len(agents), dtype=bool)])
        x0, y0, x1, y1 = world.bounds
        for places in (agents.start, agents.goal):
            assert np.all((places >= (x0, y0)) & (places <= (x1, y1)))


@pytest.mark.parametrize("name", NAMES)
def test_moving_obstacles_keep_clear_of_static_ones(name):
    for seed in range(5):
        world = build(SCENARIOS[name], "test", seed)
        for body in moving(world):
            path = swept(body.law, body.solid.bounding_radius)
            for arrangement in (starting_solids(world), ending_solids(world)):
                assert min(slow.gap(capsule[None], arrangement) for capsule in path) > 0


@pytest.mark.parametrize(
    ("name", "step"),
    [("leaders/static", 0.1), ("leaders/moving-furniture", 0.1), ("maze/grid", 0.1),
     ("bottleneck/door", 0.1), ("trap/u", 0.2), ("office/rooms", 0.1)],
)  # fmt: skip
def test_a_path_on_a_fine_grid_proves_that_worlds_are_solvable(name, step):
    world = build(SCENARIOS[name], "test", 1)
    agents = world.agents
    arrangements = [starting_solids(world)]
    if world.relocates:
        arrangements.append(ending_solids(world))
    for solids in arrangements:
        for a in range(min(2, len(agents))):
            assert slow.joined(
                agents.start[a], agents.goal[a], agents.radius[a], solids, world.bounds, step
            )


@pytest.mark.parametrize("name", NAMES)
def test_pure_and_disjoint_between_splits(name):
    one = SCENARIOS[name]
    digests = {s: [world_digest(build(one, s, seed)) for seed in range(6)] for s in SPLITS}
    prepared._prepared.cache_clear()
    again = [world_digest(build(one, "test", seed)) for seed in reversed(range(6))]
    assert again[::-1] == digests["test"]
    assert len({d for of_split in digests.values() for d in of_split}) == 18
    assert is_random(one)


def test_solids_point_the_right_way():
    for name in NAMES:
        for solid in build(SCENARIOS[name], "test", 0).solids:
            areas = [
                np.sum(loop[:, 0] * np.roll(loop[:, 1], -1) - np.roll(loop[:, 0], -1) * loop[:, 1])
                for loop in solid.loops
            ]
            outside = solid.kind == Kind.WALL and len(areas) == 1 and areas[0] < 0
            assert outside or solid.is_disc or sum(areas) > 0
        kinds = [solid.kind for solid in build(SCENARIOS[name], "test", 0).solids]
        assert kinds == sorted(kinds)  # walls first


def test_moved_obstacles_stood_elsewhere():
    world = build(SCENARIOS["leaders/moved"], "test", 0)
    assert len(world.stale_solids) == len(world.solids)
    for now, then in zip(world.solids, world.stale_solids, strict=True):
        assert now.kind == then.kind
        same = np.array_equal(now.capsules, then.capsules)
        assert same == (now.kind == Kind.WALL)
    assert build(SCENARIOS["leaders/static"], "test", 0).stale_solids is None


@pytest.mark.parametrize("distance", [0, 0.5, 1.5, 4])
def test_displaced_obstacles_stood_as_far_away_as_is_said(distance):
    displaced = find(f"leaders/displaced:displacement={distance}")
    there = find("leaders/displaced:displacement=0")
    assert displaced.granted_tracks == there.granted_tracks == TRACKS
    for seed in range(8):
        world, same = build(displaced, "test", seed), build(there, "test", seed)
        pairs = list(zip(world.solids, world.stale_solids, strict=True))
        furniture = [(now, then) for now, then in pairs if now.kind == Kind.STATIC]
        apart = [np.hypot(*np.subtract(now.center, then.center)) for now, then in furniture]
        assert apart == pytest.approx([distance] * len(furniture))
        old = barrier([then for _, then in furniture[1:]])
        assert clear(furniture[0][1].capsules, np.zeros((1, 2)), old, 1.5 - 1e-9).all()
        assert world_digest(replace(world, stale_solids=None)) == world_digest(
            replace(same, stale_solids=None)
        )


def test_relocated_obstacles_are_bodies():
    world = build(SCENARIOS["leaders/moving-furniture"], "test", 0)
    assert world.relocates
    assert len(relocating(world)) == 3
    for body in relocating(world):
        assert 3 <= body.law.times[1] <= 12
        assert body.law.times[0] == 0
        assert body.solid.kind == Kind.STATIC


def test_background_agents():
    world = build(SCENARIOS["crowd/circle-crossing"], "test", 0)
    agents = world.agents
    assert agents.driver.tolist() == [0, 1, 1, 1, 1, 1]
    assert world.teams == ("robot", "people")
    assert world.sees.tolist() == [[True, True], [False, True]]
    np.testing.assert_array_equal(agents.goal[1:], -agents.start[1:])
    assert world.clock.steps == 100
    apart = np.linalg.norm(agents.start[:, None] - agents.start, axis=2)
    assert apart[~np.eye(6, dtype=bool)].min() > 0.8
    assert np.linalg.norm(agents.start[1:] - agents.goal[0], axis=1).min() > 0.8


def test_a_part_does_not_disturb_the_others():
    more = SMALL + (
        "  - {name: late, count: 2, radius: 0.1, max_speed: 1,\n"
        "     start: {type: region, region: {type: anywhere}},\n"
        "     goal: {type: region, region: {type: anywhere}}}\n"
    )
    for seed in range(5):
        one, other = build(scenario(), "test", seed), build(scenario(more), "test", seed)
        assert [s.capsules.tolist() for s in one.solids] == [
            s.capsules.tolist() for s in other.solids
        ]
        np.testing.assert_array_equal(one.agents.start, other.agents.start[:3])


def test_without_randomness_worlds_coincide_and_that_is_reported():
    text = SMALL[: SMALL.index("static:")] + (
        "teams:\n  - {name: a, radius: 0.2, max_speed: 1,\n"
        "     start: {type: points, points: [[1, 1]]}, goal: {type: points, points: [[9, 9]]}}\n"
    )
    fixed = scenario(text)
    assert not is_random(fixed)
    assert coincidences(fixed, [0, 1]) == [tuple((s, k) for s in SPLITS for k in (0, 1))]
    assert coincidences(scenario(), [0, 1]) == []


@pytest.mark.parametrize("width", [0.35, 0.39, 0.41, 0.45])
def test_a_door_is_passable_where_it_is_wider_than_the_agent(width):
    half = (10 - width) / 2
    text = (
        "name: tests/door\nbounds: [0, 0, 10, 10]\nwalls:\n"
        f"  - {{shape: {{type: box, width: 0.2, depth: {half}}}, at: [5, {half / 2}]}}\n"
        f"  - {{shape: {{type: box, width: 0.2, depth: {half}}}, at: [5, {10 - half / 2}]}}\n"
        "teams:\n  - {name: a, radius: 0.2, max_speed: 1,\n"
        "     start: {type: region, region: {type: rectangle, bounds: [0, 0, 4, 10]}},\n"
        "     goal: {type: region, region: {type: rectangle, bounds: [6, 0, 10, 10]}}}\n"
    )
    if width > 0.4:
        assert build(scenario(text), "test", 0).redraws == 0
    else:
        with pytest.raises(UnsolvableError, match=r"tests/door@1, split test, seed 0: no world"):
            build(scenario(text), "test", 0)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("count: {integers: [1, 3]}", "count: 60", r"static\[0\] \(disc \d+ of 60\)"),
        ("points: [[5, 1]]", "points: [[5, 5]]", r"the start of teams\[others\] agent 1 of 1"),
        ("center: [8, 5], radius: 1.5}, min_distance: 2",
         "center: [5, 5], radius: 0.4}, min_distance: 2", r"the goal of teams\[walkers\]"),
        ("speed: 1}\nteams", "speed: 1}\n    gap: 4\nteams", r"the path of dynamic\[0\]"),
        ("count: 2", "count: 55", r"the (start|goal) of teams\[walkers\] agent \d+ of 55"),
    ],
)  # fmt: skip
def test_what_cannot_be_drawn_says_so(old, new, message):
    assert old in SMALL
    with pytest.raises(UnsolvableError, match=message) as caught:
        build(scenario(SMALL.replace(old, new)), "validation", 3)
    assert "tests/small@1, split validation, seed 3: no world" in str(caught.value)


def test_asked_wrongly():
    with pytest.raises(UsageError, match=r"must be one of train, validation, test; got 'tests'"):
        build(scenario(), "tests", 0)
    with pytest.raises(UsageError, match=r"The seed must be ≥ 0; got -1"):
        build(scenario(), "test", -1)


def test_recorded_tracks_and_given_places(tmp_path):
    (tmp_path / "t.txt").write_text("0 7 2 2\n5 7 8 2\n0 9 2 8\n")
    text = (
        "name: tests/tracks\nbounds: [0, 0, 10, 10]\n"
        "static:\n  - {shape: {type: box, width: 1}, region: {type: anywhere}, count: 5}\n"
        "dynamic:\n"
        "  - shape: {type: disc, radius: 0.4}\n"
        "    law: {type: recorded-track, file: t.txt, format: text, frame_time: 2}\n"
        "  - shape: {type: box, width: 0.5}\n    at: [[5, 5]]\n"
        "    law: {type: circle, radius: 1, speed: 1}\n"
        "teams:\n  - {name: a, radius: 0.2, max_speed: 1,\n"
        "     start: {type: points, points: [[1, 5]]}, goal: {type: points, points: [[9, 5]]}}\n"
    )
    (tmp_path / "s.yaml").write_text(text)
    for seed in range(10):
        world = build(load_scenario(tmp_path / "s.yaml"), "test", seed)
        assert world.redraws == 0  # static obstacles keep clear of what is given
        first, second, circle = world.bodies
        np.testing.assert_allclose(first.law.times, [0, 10])
        np.testing.assert_allclose(second.law.points, [[2, 8]])
        assert circle.law.kind == LawKind.CIRCLE


def test_occupancy_maps_are_walls(tmp_path):
    rows = ["@@@@@@", "@....@", "@.@@.@", "@....@", "@@@@@@"]
    header = f"type octile\nheight {len(rows)}\nwidth {len(rows[0])}\nmap\n"
    (tmp_path / "m.map").write_text(header + "\n".join(rows) + "\n")
    text = (
        "name: tests/map\nbounds: [0, 0, 6, 5]\nwalled: false\nwalls:\n"
        "  - shape: {type: occupancy, file: m.map, format: movingai}\n"
        "teams:\n  - {name: a, count: 2, radius: 0.3, max_speed: 1,\n"
        "     start: {type: region, region: {type: anywhere}},\n"
        "     goal: {type: region, region: {type: anywhere}, min_distance: 1}}\n"
    )
    (tmp_path / "s.yaml").write_text(text)
    world = build(load_scenario(tmp_path / "s.yaml"), "test", 0)
    for place in (*world.agents.start, *world.agents.goal):
        assert slow.clearances(place[None], world.solids)[0] > 0.3


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_whatever_is_accepted_is_drawn_or_refused(data):
    broken = mutate(read_yaml_text(SMALL, "s").data, data.draw)
    try:
        accepted = scenario_from_text(text_of(broken), "s.yaml")
    except ScenarioError:
        return
    try:
        world = build(accepted, "test", 0)
    except (UnsolvableError, InputError):
        return
    agents = world.agents
    assert len(agents.start) == len(agents.goal) == len(agents.radius) >= 1
    assert np.isfinite(agents.start).all()
    assert np.isfinite(agents.goal).all()
