"""What is walled off is called unreachable, with file and line; what has no room is not."""

import pytest

from benchnav.errors import UnsolvableError
from benchnav.generation.build import build
from benchnav.scenario.load import scenario_from_text

TEXT = """\
name: tests/walled
bounds: [-5, -5, 5, 5]
BLOCK
teams:
  - name: one
    radius: 0.2
    max_speed: 1
    start: START
    goal: GOAL
"""
WALL = "walls: [{shape: {type: polyline, points: [[0, -5], [0, 5]], thickness: 0.2}}]"
GAP = "walls: [{shape: {type: polyline, points: [[0, -5], [0, 4.7]], thickness: 0.2}}]"
CUBE = "static: [{shape: {type: box, width: 0.3, depth: 9.9}, at: [0, 0]}]"
DRAWN = CUBE.replace("at: [0, 0]", "region: {type: points, points: [[0, 0]]}")
POINT = "{type: points, points: [[-4, 0]]}"
LEFT = "{type: region, region: {type: rectangle, bounds: [-4.5, -4.5, -1, 4.5]}}"
RIGHT = "{type: region, region: {type: rectangle, bounds: [1, -4.5, 4.5, 4.5]}}"
THERE = "{type: points, points: [[4, 0]]}"


def refused(block, start, goal):
    text = TEXT.replace("BLOCK", block).replace("START", start).replace("GOAL", goal)
    with pytest.raises(UnsolvableError) as caught:
        build(scenario_from_text(text, "s.yaml"), "test", 0)
    return str(caught.value)


@pytest.mark.parametrize("block", [WALL, GAP, CUBE, DRAWN], ids=["wall", "gap", "cube", "drawn"])
@pytest.mark.parametrize("start", [POINT, LEFT], ids=["point", "region"])
@pytest.mark.parametrize(
    "goal",
    [THERE, RIGHT, "{type: antipodal}", "{type: shifted, by: [6.5, 0]}"],
    ids=["point", "region", "antipodal", "shifted"],
)
def test_what_is_walled_off_is_unreachable(block, start, goal):
    said = refused(block, start, goal)
    assert "the goal of teams[one] agent 1 of 1 is unreachable from its start" in said
    assert "\ns.yaml:9: teams[0].goal of 'one' is walled off from the start: no path" in said
    assert "is 0.4 m wide" in said
    assert "no free place" not in said


def test_a_goal_in_a_wall_is_blocked_and_not_unreachable():
    said = refused(WALL, POINT, "{type: points, points: [[0, 1]]}")
    assert "lies in or too close to a wall or obstacle" in said
    assert "\ns.yaml:9: teams[0].goal of 'one' must be 0.2 m, the agents' radius, away" in said
    assert "unreachable" not in said


def test_a_start_in_a_wall_is_named_with_its_line():
    said = refused(WALL, "{type: points, points: [[0, 1]]}", THERE)
    assert "no free place for the start of teams[one] agent 1 of 1" in said
    assert "\ns.yaml:8: teams[0].start of 'one' has no free place" in said


def test_a_region_of_which_a_part_can_be_reached_is_drawn_in():
    anywhere = "{type: region, region: {type: anywhere}}"
    text = TEXT.replace("BLOCK", WALL).replace("START", LEFT).replace("GOAL", anywhere)
    world = build(scenario_from_text(text, "s.yaml"), "test", 0)
    assert world.agents.goal[0, 0] < 0.0
