"""How many agents fit: bounds no packing beats, lattices, and what too large a team is told."""

import numpy as np
import pytest

from benchnav.errors import ScenarioError, UnsolvableError
from benchnav.generation.build import build
from benchnav.scenario.load import scenario_from_text
from benchnav.scenario.sampling.packing import inside_region, lattice, most_that_fit
from benchnav.scenario.sampling.region import Anywhere, DiscRegion, Points, Rectangle, Ring

ARENA = (-50.0, -50.0, 50.0, 50.0)
REGIONS = [
    Rectangle(type="rectangle", bounds=(-3.0, 1.0, 4.0, 3.5)),
    Rectangle(type="rectangle", bounds=(0.0, 0.0, 0.5, 0.5)),
    DiscRegion(type="disc", center=(1.0, -2.0), radius=3.0),
    Ring(type="ring", center=(0.0, 0.0), inner=2.0, outer=4.0),
]


@pytest.mark.parametrize("region", REGIONS, ids=lambda r: r.type)
@pytest.mark.parametrize("least", [0.31, 0.5, 1.7])
def test_no_lattice_beats_the_bound_and_the_best_comes_near(region, least):
    most = most_that_fit(region, ARENA, least, 0.0)
    rng = np.random.default_rng(0)
    box = np.array(region.box(ARENA))
    best = max(
        len(lattice(tuple(rng.uniform(box[:2], box[2:])), least, region, ARENA, 5000))
        for _ in range(40)
    )
    assert best <= most
    if most > 50 and region.type != "ring":
        assert best > 0.75 * most


def test_bounds_in_closed_form():
    """Two points at the ends of a line, four at the corners of a square, one where all is near."""
    line = Rectangle(type="rectangle", bounds=(0.0, -5.0, 4.0, 5.0))
    assert most_that_fit(line, (0.0, -0.5, 4.0, 0.5), 1.0, 0.5) == 4  # 3 m of line: 0, 1, 2, 3
    square = Rectangle(type="rectangle", bounds=(0.0, 0.0, 1.0, 1.0))
    assert most_that_fit(square, ARENA, 1.0, 0.0) == 4
    assert most_that_fit(square, ARENA, 100.0, 0.0) == 1
    assert most_that_fit(square, (0.0, 0.0, 1.0, 1.0), 0.1, 0.6) == 0
    assert most_that_fit(Points(type="points", points=((0, 0), (1, 1))), ARENA, 1.0, 0.0) == 2


@pytest.mark.parametrize("region", [*REGIONS, Anywhere(type="anywhere", margin=45.0)])
def test_lattices_are_apart_inside_and_nearest_first(region):
    front = (0.3, 0.2)
    points = lattice(front, 0.4, region, ARENA, 60)
    assert len(points) > 0
    assert inside_region(region, ARENA, points).all()
    away = np.hypot(*(points - np.array(front)).T)
    assert (np.diff(away) > -1e-6).all()
    gaps = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    assert gaps[~np.eye(len(points), dtype=bool)].min(initial=9.0) >= 0.4 - 1e-9
    few = lattice(front, 0.4, region, ARENA, 5)
    np.testing.assert_array_equal(few, points[:5])


def test_a_lattice_is_whole():
    """As many points as a plain loop over rows and columns finds."""
    region = DiscRegion(type="disc", center=(7.0, 1.0), radius=2.0)
    points = lattice((0.0, 0.0), 0.5, region, ARENA, 5000)
    expected = sum(
        (0.5 * (i + 0.5 * (j % 2)) - 7.0) ** 2 + (0.5 * np.sqrt(0.75) * j - 1.0) ** 2 <= 4.0
        for i in range(-60, 60)
        for j in range(-60, 60)
    )
    assert len(points) == expected


HALL = """\
name: tests/hall
bounds: [0, 0, 20, 10]
teams:
  - name: many
    count: {integers: [10, COUNT]}
    radius: 0.25
    max_speed: 1.5
    start: START
    goal: GOAL
"""
NARROW = "{type: region, region: {type: rectangle, bounds: [0, 0, 4, 4]}, separation: 0.1}"
WIDE = "{type: region, region: {type: rectangle, bounds: [10, 0, 20, 10]}}"
PACKED = (
    "{type: packed, region: {type: rectangle, bounds: [1, 1, 4, 4]}, front: [5, 2], spacing: 0.6}"
)


def _hall(count, start=NARROW, goal=WIDE):
    text = HALL.replace("COUNT", str(count)).replace("START", start).replace("GOAL", goal)
    return scenario_from_text(text, "hall.yaml")


@pytest.mark.parametrize(
    ("count", "start", "goal", "message"),
    [
        (60, NARROW, WIDE,
         "hall.yaml:8: teams[0].start must have room for all of 'many', up to 60 agents;"
         " the region holds at most 58 agents of radius 0.25 m that are 0.1 m apart, in the"
         " densest packing."),
        (60, WIDE, NARROW.replace(", separation: 0.1", ""),
         None),
        (90, WIDE, NARROW.replace(", separation: 0.1", ""),
         "hall.yaml:9: teams[0].goal must have room for all of 'many', up to 90 agents;"
         " the region holds at most 80 agents of radius 0.25 m, in the densest packing."),
        (60, PACKED, "{type: shifted, by: [10, 0]}",
         "hall.yaml:8: teams[0].start must have room for all of 'many', up to 60 agents;"
         " the region holds 25 points 0.6 m apart."),
    ],
)  # fmt: skip
def test_a_team_that_is_larger_than_its_region(count, start, goal, message):
    if message is None:
        assert _hall(count, start, goal).name == "tests/hall"
        return
    with pytest.raises(ScenarioError) as caught:
        _hall(count, start, goal)
    assert str(caught.value) == message


def test_a_team_that_only_a_perfect_packing_would_hold_is_told_where_and_how_many_fit():
    text = HALL.replace("{integers: [10, COUNT]}", "48").replace("START", NARROW)
    scenario = scenario_from_text(text.replace("GOAL", WIDE), "hall.yaml")
    with pytest.raises(UnsolvableError) as caught:
        build(scenario, "test", 0)
    said = str(caught.value)
    assert "no free place for the start of teams[many] agent" in said
    assert said.endswith(
        "\nhall.yaml:8: teams[0].start of 'many' holds at most 58 agents of radius 0.25 m that are"
        " 0.1 m apart, densely packed and without other objects; at random places, about half as"
        " many fit."
    )


def test_packed_agents_stand_on_their_lattice_and_arrive_as_they_stood():
    scenario = _hall(25, PACKED, "{type: shifted, by: [10, 2]}")
    world = build(scenario, "test", 3)
    count = len(world.agents)
    expected = lattice((5.0, 2.0), 0.6, scenario.teams[0].start.region, scenario.bounds, count)
    np.testing.assert_array_equal(world.agents.start, expected)
    np.testing.assert_allclose(world.agents.goal - world.agents.start, [[10.0, 2.0]] * count)


def test_packed_agents_are_shaken_by_no_more_than_half_the_jitter():
    start = PACKED.replace("spacing: 0.6", "spacing: 0.6, jitter: 0.06, separation: 0.01")
    scenario = _hall(25, start, "{type: antipodal, center: [10, 5]}")
    for seed in range(3):
        world = build(scenario, "test", seed)
        start_ = scenario.teams[0].start
        stands = lattice((5.0, 2.0), 0.6, start_.region, scenario.bounds, len(world.agents))
        shaken = np.abs(world.agents.start - stands)
        assert 0.01 < shaken.max() <= 0.03
        np.testing.assert_allclose(world.agents.goal, [20.0, 10.0] - world.agents.start)
