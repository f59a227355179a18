"""Scenarios whose background agents enter later: keys, draws, starts, hashes and mistakes."""

import numpy as np
import pytest

from benchnav.errors import ScenarioError
from benchnav.generation.build import build
from benchnav.generation.world_digest import world_digest
from benchnav.scenario.load import scenario_from_text
from benchnav.store.parts.world_codec import world_from_json, world_to_json
from tests.plain_scenario import PLAIN

REGION = "{type: region, region: {type: rectangle, bounds: [-4, 1, -2, 2]}}"
SPOT = "{type: region, region: {type: rectangle, bounds: [-4, 1, -3.9, 1.1]}}"
TEAM = """\
  - name: walkers
    count: COUNT
    radius: 0.2
    max_speed: 1
    start: START
    goal: GOAL
    driver: orca
    enters: ENTERS
"""


def scenario(enters, count=3, place=REGION):
    team = TEAM.replace("COUNT", str(count)).replace("START", place).replace("GOAL", place)
    team = team.replace("    enters: ENTERS\n", "") if enters is None else team
    return scenario_from_text(PLAIN + team.replace("ENTERS", enters or ""), "s.yaml")


def entries(enters, count=3, seed=0, place=REGION):
    world = build(scenario(enters, count, place), "test", seed)
    return world.agents.enters[world.agents.driver > 0]


def test_times_are_given_drawn_or_a_stream():
    np.testing.assert_array_equal(entries("[4, 0, 2.5]"), [4, 0, 2.5])
    np.testing.assert_array_equal(entries("[4, 0, 2.5, 9]"), [4, 0, 2.5])
    np.testing.assert_array_equal(entries("{every: 2}"), [0, 2, 4])
    np.testing.assert_array_equal(entries("{every: 2, begin: 1.5}"), [1.5, 3.5, 5.5])
    drawn = entries("{uniform: [1, 3]}", count=8)
    assert len(set(drawn)) == 8
    assert ((drawn >= 1) & (drawn < 3)).all()
    stream = entries("{every: {uniform: [0.5, 1]}, begin: 2}", count=8)
    assert stream[0] == 2.0
    assert ((np.diff(stream) >= 0.5) & (np.diff(stream) < 1.0)).all()
    np.testing.assert_array_equal(stream, entries("{every: {uniform: [0.5, 1]}, begin: 2}", 8))
    assert (stream != entries("{every: {uniform: [0.5, 1]}, begin: 2}", 8, seed=1))[1:].all()


def test_many_agents_can_come_from_a_small_region_one_after_another():
    assert len(entries("{every: 1}", count=15, place=SPOT)) == 15
    with pytest.raises(ScenarioError, match="must have room for all of 'walkers'"):
        scenario("5", count=40, place=SPOT)


def test_those_who_enter_together_start_apart_and_others_need_not():
    agents = build(scenario("[0, 0, 1, 1, 2, 3]", count=6), "test", 4).agents
    for time in (0.0, 1.0):
        place = agents.start[(agents.enters == time) & (agents.driver > 0)]
        assert np.hypot(*(place[0] - place[1])) > 0.4


def test_a_time_of_zero_is_no_key_and_times_change_only_the_column():
    plain, without = scenario("0"), scenario(None)
    assert plain.hash == without.hash
    assert scenario("1").hash != plain.hash
    world, other = build(plain, "test", 3), build(without, "test", 3)
    assert world_digest(world) == world_digest(other)
    assert world_to_json(world) == world_to_json(other)
    assert b"enters" not in world_to_json(world)
    later = build(scenario("1"), "test", 3)
    assert world_digest(later) != world_digest(world)
    back = world_from_json(world_to_json(later).decode())
    np.testing.assert_array_equal(back.agents.enters, later.agents.enters)


@pytest.mark.parametrize(
    ("enters", "message"),
    [
        ("-1", r"s\.yaml:\d+: teams\[1\]\.enters must be ≥ 0; got -1"),
        ("soon", r"teams\[1\]\.enters must be a time \[s\], a distribution such as .* got 'soon'"),
        ("[1, 2]", r"teams\[1\]\.enters must have a time for each of up to 3 agents; got 2"),
        ("[1, 2, -3]", r"teams\[1\]\.enters\[2\] must be ≥ 0; got -3"),
        ("[]", r"teams\[1\]\.enters must have at least 1 entries"),
        ("{every: 0}", r"teams\[1\]\.enters\.every must be > 0; got 0"),
        ("{begin: 2}", r"teams\[1\]\.enters\.every must be given"),
        ("{evry: 2}", r"teams\[1\]\.enters must be a time \[s\]"),
        ("{every: 1, start: 2}", r"teams\[1\]\.enters\.start is not a known key"),
        ("{uniform: [3, 1]}", r"teams\[1\]\.enters\.uniform must be \[low, high\]"),
        ("1e4", r"teams\[1\]\.enters must be before the horizon of .* s; the first agent enters"),
    ],
)
def test_mistakes_are_one_sentence_with_file_and_line(enters, message):
    with pytest.raises(ScenarioError, match=message) as caught:
        scenario(enters)
    assert len(str(caught.value).splitlines()) == 1


def test_agents_of_the_evaluated_navigator_start_at_once():
    text = PLAIN.replace("    max_speed:", "    enters: 3\n    max_speed:", 1)
    assert "enters" in text
    with pytest.raises(ScenarioError, match=r"teams\[0\]\.enters must be 0, or left out, for agen"):
        scenario_from_text(text, "s.yaml")
