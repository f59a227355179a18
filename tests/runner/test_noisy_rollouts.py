"""Whole episodes in the perception track `noisy`."""

from dataclasses import replace

import numpy as np
import pytest

from benchnav.arena.noise import Noise, OdometryNoise
from benchnav.generation.build import build, noise_of
from benchnav.navigation.navigator import Navigator
from benchnav.plugins import NAVIGATORS
from benchnav.runner.rollouts import rollout
from benchnav.runner.rollouts.latency import latency
from benchnav.runner.rollouts.rehearsal import perform
from benchnav.runner.rollouts.rollout import Assignment
from benchnav.scenario.catalogue import find
from benchnav.verify.resimulation import resimulate
from tests.worlds import agents, walls, world

SEEDS = range(4)


def assigned(name, navigator, noise="scenario", **more):
    scenario = find(name)
    noise = noise_of(scenario) if noise == "scenario" else noise
    return Assignment(
        scenario.identity, scenario.hash, "test", "known", navigator, navigator,
        scenario.driver_specs, salt="5a", noise=noise, **more,
    )  # fmt: skip


def play(assignment, seeds=SEEDS):
    scenario = find(assignment.scenario.partition("@")[0])
    worlds = [(seed, build(scenario, "test", seed)) for seed in seeds]
    episodes = [e for batch in rollout.rollout(assignment, worlds) for e in batch]
    return {e.identity.seed: e for e in episodes}


def digests(assignment, seeds=SEEDS):
    return {seed: e.digest for seed, e in play(assignment, seeds).items()}


@pytest.mark.parametrize(
    "name", ["leaders/dynamic", "leaders/moving-furniture", "crowd/circle-crossing"]
)
def test_without_noise_the_tracks_are_equal_to_the_last_bit(name):
    assert digests(assigned(name, "orca", Noise())) == digests(assigned(name, "orca", None))


@pytest.mark.parametrize("navigator", ["orca", "straight-line", "none+dwa"])
def test_noisy_episodes_are_repeated_whatever_the_batch(navigator, monkeypatch):
    together = digests(assigned("leaders/dynamic", navigator))
    assert together != digests(assigned("leaders/dynamic", navigator, None))
    monkeypatch.setattr(rollout, "MAX_WORLDS", 1)
    assert digests(assigned("leaders/dynamic", navigator), SEEDS[::-1]) == together


@pytest.mark.parametrize("navigator", ["orca", "none+dwa"])
def test_isolated_navigators_meet_the_same_noise_to_the_last_bit(navigator):
    here = digests(assigned("leaders/dynamic", navigator))
    assert digests(assigned("leaders/dynamic", navigator, isolated=True)) == here


def test_the_salt_is_part_of_the_noise_and_of_nothing_else():
    """The straight line draws no random numbers."""
    one, other = (
        digests(replace(assigned("leaders/dynamic", "straight-line"), salt=salt))
        for salt in ("5a", "5b")
    )
    assert all(one[seed] != other[seed] for seed in SEEDS)
    exact = assigned("leaders/dynamic", "straight-line", None)
    assert digests(exact) == digests(replace(exact, salt="5b"))


def test_stored_commands_are_in_the_world_frame_so_that_they_are_simulated_again():
    episodes = play(assigned("leaders/dynamic", "orca"))
    for episode, again in zip(
        episodes.values(), resimulate([(e.world, e) for e in episodes.values()]), strict=True
    ):
        assert again.wrong == ""
        np.testing.assert_array_equal(again.episode.position, episode.position)


class Compass(Navigator):
    """Drives at its goal with 1 m/s, until it believes that it has arrived."""

    def act(self, observation):
        way = observation.goal - observation.position
        return way / np.maximum(np.linalg.norm(way, axis=2, keepdims=True), 1.0)


@pytest.fixture
def compass(monkeypatch):
    monkeypatch.setitem(NAVIGATORS._local, "tests-compass", (Compass, "tests:Compass"))
    return "tests-compass"


def drives(compass, noise):
    start = [[2.0, 10.0]]
    one = world(agents(start, [[17.0, 10.0]], radius=0.2), [walls(20.0)], tolerance=0.15)
    about = Assignment("s", "h", "test", "known", "c", compass, salt="00", noise=noise)
    worlds = [(seed, one) for seed in range(40)]
    return [e for batch in rollout.rollout(about, worlds) for e in batch]


def test_an_agent_that_drifts_misses_its_goal_and_one_that_is_corrected_arrives(compass):
    """Arrival is judged by the true pose."""
    drift = OdometryNoise(0.02, 0.04, 0.0)
    lost = drives(compass, Noise(odometry=drift))
    arrived = np.mean([np.isfinite(e.arrival[0]) for e in lost])
    assert 0.0 < arrived < 0.5
    end = np.array([e.position[-1, 0] - e.world.agents.goal[0] for e in lost])
    assert np.linalg.norm(end, axis=1).max() > 0.3
    corrected = replace(drift, correction_period=1.0, correction_position_noise=0.05)
    found = drives(compass, Noise(odometry=corrected))
    assert all(np.isfinite(e.arrival[0]) for e in found)


def test_under_drift_of_the_heading_the_body_drives_where_its_own_frame_points(compass):
    """A correction that errs in the heading only: the way is turned about the agent."""
    noise = Noise(odometry=OdometryNoise(correction_period=0.2, correction_heading_noise=0.5))
    episodes = drives(compass, noise)
    step = np.array([e.position[2, 0] - e.position[1, 0] for e in episodes])
    angle = np.arctan2(step[:, 1], step[:, 0])
    assert 0.3 < angle.std() < 0.8
    np.testing.assert_allclose(np.linalg.norm(step, axis=1), 0.2, atol=1e-9)


def test_rehearsals_are_noisy_too_each_with_its_own_noise():
    pytest.importorskip("shapely")
    spec = {"type": "guided-crowd", "rehearsal": 2, "leader": "straight-line"}
    name = "groups/crossing:followers=4"
    scenario = find(name)
    worlds = [(seed, build(scenario, "test", seed)) for seed in range(2)]

    def rehearsed(noise):
        about = Assignment(
            scenario.identity, scenario.hash, "test", "unknown", "guided", spec,
            scenario.driver_specs, salt="0a", rehearsals=2, leader="straight-line", noise=noise,
        )  # fmt: skip
        done = [p for batch in perform(about, worlds) for p in batch]
        return [[e.digest for e in p.rehearsed.episodes] for p in done]

    exact, noisy = rehearsed(None), rehearsed(noise_of(scenario))
    assert all(a != b for one, other in zip(exact, noisy, strict=True)
               for a, b in zip(one, other, strict=True))  # fmt: skip
    assert noisy == rehearsed(noise_of(scenario))


def test_latency_is_measured_with_noisy_senses():
    assignment = assigned("leaders/dynamic", "straight-line")
    world = build(find("leaders/dynamic"), "test", 0)
    assert (latency(assignment, (0, world)) > 0).all()
