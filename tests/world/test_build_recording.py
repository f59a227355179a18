"""Worlds of a recording: the person that is replaced, the clock, and people that react."""

import numpy as np
import pytest

from benchnav.arena.body import absent
from benchnav.errors import ScenarioError, UnsolvableError
from benchnav.generation.build import build
from benchnav.scenario.load import scenario_from_text
from benchnav.verify.reference.reference_geometry import law_position

# id: first frame, start, step; each has six rows, two frames a second
PEOPLE = {
    1: (0, (0.0, 0.0), (1.0, 0.0)),
    2: (2, (5.0, 3.0), (-1.0, 0.0)),
    3: (4, (2.0, -4.0), (0.0, 1.0)),
    9: (30, (0.0, 4.0), (0.1, 0.0)),
}
TEAM = (
    "  - {name: robot, radius: 0.2, max_speed: 1, start: {type: recorded}, goal: {type: recorded}}"
)


def scenario(folder, recording="", team=TEAM, rows=PEOPLE):
    table = [
        f"{first + k} {n} {x + k * dx} {y + k * dy}"
        for n, (first, (x, y), (dx, dy)) in rows.items()
        for k in range(6)
    ]
    (folder / "people.txt").write_text("\n".join(table))
    text = (
        "name: people/few\nbounds: [-10, -10, 10, 10]\n"
        f"recording: {{file: people.txt, frame_time: 0.5{recording}}}\nteams:\n{team}\n"
        "clock: {dt: 0.5, horizon: 5}\n"
    )
    return scenario_from_text(text, "few.yaml", folder)


def test_the_robot_takes_start_goal_and_time_of_a_person(tmp_path):
    world = build(scenario(tmp_path, ", replace: 2"), "test", 0)
    np.testing.assert_array_equal(world.agents.start, [[5, 3]])
    np.testing.assert_array_equal(world.agents.goal, [[0, 3]])
    assert len(world.bodies) == 2  # 1 and 3; 9 comes after the horizon
    first, third = world.bodies
    np.testing.assert_allclose(law_position(first, 0.0, False), [2, 0])  # at 1 s of the recording
    np.testing.assert_allclose(law_position(first, 1.5, False), [5, 0])
    assert absent(law_position(first, 1.6, False))
    assert absent(law_position(third, 0.9, False))
    np.testing.assert_allclose(law_position(third, 1.0, False), [2, -4])


def test_the_seed_draws_the_person(tmp_path):
    few = scenario(tmp_path, ", min_distance: 2")
    worlds = [build(few, "test", seed) for seed in range(30)]
    starts = {tuple(world.agents.start[0]) for world in worlds}
    assert starts == {PEOPLE[n][1] for n in (1, 2, 3)}  # 9 hardly moves
    again = build(few, "test", 7)
    np.testing.assert_array_equal(again.agents.start, worlds[7].agents.start)


def test_without_replacement_the_episode_begins_with_the_recording(tmp_path):
    team = (
        "  - {name: robot, radius: 0.2, max_speed: 1, start: {type: points, points: [[8, 8]]},"
        " goal: {type: points, points: [[-8, 8]]}}"
    )
    world = build(scenario(tmp_path, ", replace: none", team), "test", 0)
    assert len(world.bodies) == 3
    later = build(scenario(tmp_path, ", replace: none, begin: 14.5", team), "test", 0)
    (body,) = later.bodies
    assert absent(law_position(body, 0.4, False))
    np.testing.assert_allclose(law_position(body, 0.5, False), [0, 4])


def test_those_present_react_from_where_they_are(tmp_path):
    few = scenario(tmp_path, ", replace: 3, driver: orca")
    world = build(few, "test", 0)
    assert world.teams == ("robot", "people")
    np.testing.assert_array_equal(world.agents.start, [[2, -4], [4, 0], [3, 3]])
    np.testing.assert_array_equal(world.agents.goal, [[2, 1], [5, 0], [0, 3]])
    np.testing.assert_array_equal(world.agents.driver, [0, 1, 1])
    np.testing.assert_allclose(world.agents.preferred_speed[1:], 2.0)
    assert [choice.type for choice in few.drivers] == ["orca"]
    assert not world.bodies


def test_those_who_come_later_react_from_where_and_when_they_appear(tmp_path):
    world = build(scenario(tmp_path, ", replace: 1, driver: orca"), "test", 0)
    assert not world.bodies  # 9 comes after the horizon
    np.testing.assert_array_equal(world.agents.start, [[0, 0], [5, 3], [2, -4]])
    np.testing.assert_array_equal(world.agents.goal, [[5, 0], [0, 3], [2, 1]])
    np.testing.assert_array_equal(world.agents.enters, [0, 1, 2])


def test_those_who_come_later_may_appear_where_others_start(tmp_path):
    """The robot replaces 1; 2 is where the robot starts, but one second later."""
    close = {1: PEOPLE[1], 2: (2, (0.1, 0.1), (1.0, 0.0)), 3: (4, (0.1, 0.1), (1.0, 0.0))}
    world = build(scenario(tmp_path, ", replace: 1, driver: orca", rows=close), "test", 0)
    np.testing.assert_array_equal(world.agents.start, [[0, 0], [0.1, 0.1], [0.1, 0.1]])
    np.testing.assert_array_equal(world.agents.enters, [0, 1, 2])


def test_a_start_that_another_person_is_in_cannot_be_taken(tmp_path):
    close = {1: PEOPLE[1], 2: (0, (0.1, 0.1), (1.0, 0.0))}
    with pytest.raises(UnsolvableError, match=r"the start of teams\[robot\]"):
        build(scenario(tmp_path, ", replace: 1", rows=close), "test", 0)


@pytest.mark.parametrize(
    ("recording", "team", "message"),
    [
        (", replace: 4", TEAM, r"people\.txt:1: the file must hold id 4, .*it has 1, 2, 3, 9\."),
        (", min_distance: 30", TEAM, "a person whose start and goal are 30 m apart"),
        (", replace: none", TEAM, r"teams\[0\]\.start needs a `recording`"),
        (", begin: 3", TEAM, "begin must not be given unless `replace` is `none`"),
        (", driver: evaluated", TEAM, "must be a background navigator"),
        ("", TEAM.replace("goal: {type: recorded}", "goal: {type: shifted, by: [1, 1]}"), "goal"),
        ("", TEAM.replace("radius", "count: 2, radius"), "must be of one evaluated agent"),
        (", columns: [id, frame, x, x]", TEAM, "must name 'x' once"),
    ],
)
def test_refusals(tmp_path, recording, team, message):
    with pytest.raises(ScenarioError, match=message):
        build(scenario(tmp_path, recording, team), "test", 0)


def test_recorded_people_are_people_whether_they_react_or_not(tmp_path):
    follows = build(scenario(tmp_path, ", replace: 2"), "test", 0)
    assert [len(part) for part in follows.people] == [0, 2]
    reacts = build(scenario(tmp_path, ", replace: 2, driver: social-force"), "test", 0)
    assert [len(part) for part in reacts.people] == [2, 0]
    assert reacts.has_people
