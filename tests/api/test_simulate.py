"""Scenarios, worlds and episodes in memory."""

import math

import numpy as np
import pytest

import benchnav
from benchnav.errors import PluginError, UnknownPluginError, UsageError
from benchnav.navigation.navigator import AgentNavigator


def test_a_scenario_has_parameters_and_worlds(scenario_file):
    scenario = benchnav.load_scenario(scenario_file, size=0.1)
    assert scenario.identity == "tiny/open@1:size=0.1"
    assert scenario.parameters == {"size": 0.1}
    assert scenario.tracks == ("known", "partial", "unknown")
    world = scenario.world(seed=3)
    assert world.record.agents.radius.tolist() == [0.1, 0.1]
    assert repr(scenario) == (
        "Scenario('tiny/open@1:size=0.1': Two discs that change places; 1 team)"
    )
    assert repr(world) == (
        "World('tiny/open@1:size=0.1', split='test', seed=3: 2 agents, 1 solid, 0 moving obstacles)"
    )
    assert world._repr_html_().startswith("<svg")
    assert "of a disc" not in scenario._repr_html_()
    with pytest.raises(UsageError, match="Did you mean 'size'"):
        benchnav.load_scenario(scenario_file, sise=0.1)


def test_an_episode_is_simulated_in_memory(world):
    episode = benchnav.simulate(world, "orca", track="unknown")
    assert (episode.navigator, episode.track, episode.seed) == ("orca", "unknown", 1)
    assert 0.0 <= episode.metric("success") <= 1.0
    assert episode.metrics()["success"] == episode.metric("success")
    assert episode.roles == ("leader",)
    assert len(repr(episode)) < 200
    assert "<svg" in episode._repr_html_()


def test_the_same_salt_gives_the_same_episode(world):
    first, second, other = (
        benchnav.simulate(world, "random-walk", salt=salt) for salt in ("5a", "5A", "5b")
    )
    assert np.array_equal(first.record.position, second.record.position)
    assert not np.array_equal(first.record.position, other.record.position)
    with pytest.raises(UsageError, match="The salt must be"):
        benchnav.simulate(world, "orca", salt="x")


def test_an_episode_is_a_data_frame_of_trajectories(world):
    episode = benchnav.simulate(world, "straight-line")
    frame = episode.to_pandas()
    assert list(frame.columns) == ["time", "agent", "x", "y", "heading", "vx", "vy", "status"]
    states, agents = episode.record.status.shape
    assert len(frame) == states * agents
    own = frame[frame.agent == 1]
    assert np.array_equal(own[["x", "y"]], episode.record.position[:, 1])
    assert own.time.tolist() == episode.record.times.tolist()
    moving = own[own.status == "active"][:5]
    assert np.allclose(np.diff(moving.x), 0.2 * moving.vx[:-1])
    assert set(frame.status) <= {"active", "arrived", "ended", "failed"}


class Gain(AgentNavigator):
    """Goes to the goal, with a gain that no Config holds."""

    def __init__(self, gain):
        super().__init__()
        self.gain = gain

    def act_agent(self, view, briefing):
        return self.gain * (view.goal - view.position)


def test_an_instance_keeps_its_state(world):
    slow, fast = (benchnav.simulate(world, Gain(gain)) for gain in (0.01, 1.0))
    assert slow.metric("path_length") < fast.metric("path_length")
    assert slow.navigator == "Gain"


def test_a_failure_is_in_the_episode(world):
    def broken(view, briefing):
        raise ValueError("no idea")

    episode = benchnav.simulate(world, broken)
    assert "ValueError: no idea" in episode.failure
    assert "no idea" in repr(episode)
    assert episode.metric("failed") == 1.0


@pytest.mark.parametrize(
    ("navigator", "options", "error", "text"),
    [
        ("orka", {}, UnknownPluginError, "Did you mean 'orca'"),
        (3, {}, UsageError, "A navigator must be a name"),
        (dict, {}, UsageError, "Got <class 'dict'> instead"),
        (lambda: 0, {}, PluginError, "takes one argument"),
        ("navmesh+orca", {"track": "unknown"}, UsageError, "needs a map"),
        ("orca", {"track": "blind"}, UsageError, "A track must be one of"),
    ],
)
def test_mistakes_are_explained(world, navigator, options, error, text):
    with pytest.raises(error, match=text):
        benchnav.simulate(world, navigator, **options)


def test_roles_are_scored_apart(run_of_groups):
    episode = run_of_groups
    assert episode.roles == ("leader", "follower")
    with pytest.raises(UsageError, match="leader and follower are scored apart"):
        episode.metric("success")
    assert not math.isnan(episode.metric("success", role="follower"))
    with pytest.raises(UsageError, match="Did you mean 'follower'"):
        episode.metric("success", role="folower")


@pytest.fixture
def run_of_groups():
    return benchnav.simulate(benchnav.load_scenario("groups/crossing").world(), "straight-line")
