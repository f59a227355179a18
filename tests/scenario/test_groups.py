"""The group scenarios: who belongs together, that all fit at all sizes, and what two roles are."""

import time

import numpy as np
import pytest

from benchnav.arena.agents import Role
from benchnav.errors import ScenarioError
from benchnav.generation.build import build
from benchnav.scenario.catalogue import find
from benchnav.scenario.load import scenario_from_text
from tests.scenario.files import SMALL

NAMES = ("diagonal", "crossing", "crossing-four", "bottleneck", "bottleneck-opposed")


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("followers", [1, 24, 249])
def test_everybody_fits_and_every_team_has_one_leader(name, followers):
    scenario = find(f"groups/{name}:followers={followers}")
    world = build(scenario, "validation", 0)
    agents = world.agents
    for team in range(len(world.teams)):
        own = agents.team == team
        assert (agents.role[own] == Role.LEADER).sum() == 1
        assert (agents.role[own] == Role.FOLLOWER).sum() == followers
    for places in (agents.start, agents.goal):  # all at once, at the start and at the goal
        away = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))
        apart = away - agents.radius[:, None] - agents.radius
        assert apart[~np.eye(len(agents), dtype=bool)].min() > 0.0
        low, high = np.array(world.bounds[:2]), np.array(world.bounds[2:])
        assert (places - agents.radius[:, None] > low).all()
        assert (places + agents.radius[:, None] < high).all()
    assert world.measurement_area is not None


@pytest.mark.parametrize("name", NAMES)
def test_worlds_differ_and_the_smaller_group_is_the_front_of_the_larger(name):
    scenario = find(f"groups/{name}")
    one, other = (build(scenario, "validation", seed).agents for seed in (0, 1))
    assert not np.array_equal(one.start, other.start)
    large = build(find(f"groups/{name}:followers=200"), "validation", 0).agents
    small = one.team == 0
    front = large.start[large.team == 0][: small.sum()]
    np.testing.assert_allclose(one.start[small], front, atol=0.11)


def test_a_thousand_agents_are_placed_in_seconds():
    scenario = find("groups/diagonal:followers=249")
    build(scenario, "train", 0)  # compiles
    begin = time.process_time()
    assert len(build(scenario, "train", 1).agents) == 1000
    assert time.process_time() - begin < 3.0


def test_leaders_and_followers_of_one_name_are_one_team():
    text = SMALL.replace("name: others", "name: walkers\n    role: follower").replace(
        "    ignores: [walkers]\n", ""
    )
    world = build(scenario_from_text(text, "s.yaml"), "test", 0)
    assert world.teams == ("walkers",)
    assert world.agents.team.tolist() == [0, 0, 0]
    assert world.agents.role.tolist() == [0, 0, 1]
    assert world.sees.shape == (1, 1)


def test_one_team_ignores_the_same():
    text = SMALL.replace("name: others", "name: walkers\n    role: follower")
    with pytest.raises(ScenarioError) as caught:
        scenario_from_text(text, "s.yaml")
    assert str(caught.value) == (
        "s.yaml:29: teams[1].ignores must be that of teams[0]: leaders and followers of 'walkers'"
        " are one team."
    )
