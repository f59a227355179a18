"""Who gets a slot: worlds with drivers, and with other numbers of learning agents each."""

import gymnasium
import numpy as np
import pytest
from pettingzoo.test import parallel_seed_test
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import VecMonitor

from benchnav.envs.agent_batch import AgentBatch
from benchnav.envs.encoders.catalogue import encoder
from benchnav.envs.factory import make_batch
from benchnav.envs.gym.leader_env import LeaderEnv
from benchnav.envs.gym.leader_vector_env import LeaderVectorEnv
from benchnav.envs.gym.registration import LEADER
from benchnav.envs.learner_slots import LearnerSlots
from benchnav.envs.parallel_env import LeadersEnv
from benchnav.envs.reward import RewardWeights
from benchnav.envs.sb3.agent_vec_env import AgentVecEnv
from benchnav.errors import UsageError
from tests.envs.recorder import Recorder
from tests.worlds import agents, world

# people that a driver moves at random come first, then one to three robots that learn
MIXED = """\
name: mixed
version: 1
title: Robots among people
description: One to three robots learn; two people walk at random.
bounds: [-8, -8, 8, 8]
teams:
  - name: people
    count: 2
    radius: 0.3
    max_speed: 1
    start: {type: points, points: [[0, -3], [0, 3]]}
    goal: {type: points, points: [[0, 3], [0, -3]]}
    driver: random-walk
  - name: robots
    count: {integers: [1, 3]}
    radius: 0.3
    max_speed: 1
    start: {type: region, region: {type: rectangle, bounds: [-7, -7, -4, 7]}, separation: 0.2}
    goal: {type: region, region: {type: rectangle, bounds: [4, -7, 7, 7]}}
clock: {dt: 0.25, substeps: 1, horizon: 10}
rules: {goal_tolerance: 0.3, contact: end, on_arrival: stay}
"""
WORLDS = 12


@pytest.fixture(scope="module")
def mixed(tmp_path_factory):
    path = tmp_path_factory.mktemp("mixed") / "mixed.yaml"
    path.write_text(MIXED)
    return str(path)


class Still:
    """A model that stands, which its learner ends by the horizon if nothing touches it."""

    def predict(self, observation, state=None, **_):
        return np.tile(np.float32([-1, 0]), (len(observation), 1)), state


def test_learners_fill_the_slots_of_their_row_in_turn(mixed):
    batch = make_batch(mixed, "ego", "train", WORLDS, None, 6)
    slots, crowded = LearnerSlots(batch), set()
    assert slots.agent.shape == (2, 3)
    recorder, rng = Recorder(batch), np.random.default_rng(0)
    seen, attempts = slots.reset(), np.zeros(6, int)
    for _ in range(600):
        for row, here in enumerate(slots.agent):
            learners = np.flatnonzero(batch.simulation.worlds[row].agents.evaluated)
            assert sorted(here[here >= 0]) == learners.tolist()
            crowded.add(len(learners))
        row, slot = np.nonzero(slots.active)
        assert np.array_equal(seen[row, slot].any(1), np.ones(len(row), bool))
        assert not seen[~slots.active].any()
        step = slots.step(rng.uniform(-1, 1, (2, 3, 2)))
        assert not (step.over & ~step.acted).any()
        assert not step.reward[~step.acted].any()
        attempts += step.over.reshape(-1)
        seen = step.observation
    assert crowded == {1, 2, 3}
    assert attempts.sum() == len(recorder.attempts)
    assert attempts.min() > 0.5 * attempts.max()  # no slot is left out
    assert {attempt.agent for attempt in recorder.attempts} == {2, 3, 4}


def test_every_view_counts_the_agents_that_learn(mixed):
    vec = AgentVecEnv([make_batch(mixed, "ego", "train", WORLDS, None, 6)])
    assert vec.num_envs == 6
    recorder, monitor = Recorder(vec.batches[0]), VecMonitor(vec)
    rewards, _ = evaluate_policy(Still(), monitor, n_eval_episodes=24, return_episode_rewards=True)
    assert len(rewards) == 24
    assert monitor.episode_count == len(recorder.attempts)
    off = np.abs(np.subtract.outer(rewards, recorder.rewards))
    assert off.min(axis=1).max() < 1e-4  # each is the reward of an attempt that there was

    envs = gymnasium.make_vec(LEADER, num_envs=6, scenario=mixed, worlds=WORLDS)
    assert isinstance(envs.unwrapped, LeaderVectorEnv)
    assert envs.reset(seed=0)[0].shape[0] == 6

    zoo, counts = LeadersEnv(mixed, "ego", worlds=WORLDS), set()
    assert zoo.possible_agents == ["leader_0", "leader_1", "leader_2"]
    for w in range(WORLDS):
        zoo.reset(options={"world": w})
        learners = int(zoo.batch.simulation.pool[w].agents.evaluated.sum())
        assert zoo.agents == zoo.possible_agents[:learners]
        counts.add(learners)
        decisions = 0
        while zoo.agents:
            zoo.step({agent: np.float32([-1, 0]) for agent in zoo.agents})
            decisions += 1
        assert decisions <= 40
        assert zoo.step({}) == ({}, {}, {}, {}, {})
    assert counts == {1, 2, 3}
    zoo.close()
    zoo.close()

    one = LeaderEnv(mixed, worlds=WORLDS, others="orca")
    for seed in range(20):
        _, info = one.reset(seed=seed)
        _, same = one.reset(options=info)
        assert same == info
        assert one.batch.simulation.worlds[0].agents.evaluated[one.agent]


def played(env, start):
    """What a single environment shows for one attempt of turning on the spot."""
    seen, shown = env.reset(**start)[0], []
    over = False
    while not over:
        shown.append(seen)
        seen, _, terminated, truncated, _ = env.step(np.float32([-0.5, 0.3]))
        over = terminated or truncated
    return np.array(shown)


def test_a_seed_decides_what_drivers_draw_too(mixed):
    parallel_seed_test(lambda: LeadersEnv(mixed, worlds=WORLDS), num_cycles=60)
    zoo = LeadersEnv(mixed, worlds=WORLDS)
    vec = AgentVecEnv([make_batch(mixed, "ego", "train", WORLDS, None, 6)])
    envs = LeaderVectorEnv(6, mixed, worlds=WORLDS)
    paths = []
    for _ in range(2):
        zoo.reset(seed=np.int64(3))
        envs.reset(seed=3)
        vec.seed(3)
        vec.reset()
        for _ in range(10):
            zoo.step({agent: np.float32([-1, 0]) for agent in zoo.agents})
            envs.step(np.tile(np.float32([-1, 0]), (6, 1)))
            vec.step(np.tile(np.float32([-1, 0]), (6, 1)))
        batches = (zoo.batch, envs.batch, vec.batches[0])
        paths.append([batch.simulation.position.copy() for batch in batches])
    for first, again in zip(*paths, strict=True):
        np.testing.assert_array_equal(first, again)
    one = LeaderEnv(mixed, worlds=WORLDS, others="orca")
    first = played(one, {"seed": np.int64(5)})
    after = played(one, {})
    assert np.array_equal(played(one, {"seed": 5}), first)
    assert np.array_equal(played(one, {}), after)  # goes on with the generator


def driven(count):
    return world(
        agents([[4.0, 4.0 + 3 * k] for k in range(count)], [[18.0, 4.0]] * count, driver=1)
    )


def test_worlds_without_a_learner_are_left_out_and_some_must_have_one():
    learning = world(agents([[4.0, 4.0]], [[18.0, 4.0]]))
    make = lambda pool: AgentBatch(  # noqa: E731
        pool,
        1,
        encoder("ego"),
        RewardWeights(),
        np.random.default_rng(0),
        drivers=["straight-line"],
    )
    batch = make([driven(2), learning, driven(1)])
    env = AgentVecEnv([batch])
    assert env.num_envs == 1
    for _ in range(5):
        env.reset()
        assert batch.simulation.worlds[0].agents.evaluated.all()
    with pytest.raises(UsageError, match="At least one agent must learn"):
        make([driven(1), driven(2)])


def test_the_scenario_s_own_people_are_no_agents_of_pettingzoo():
    env = LeadersEnv("crowd/circle-crossing", "ego", worlds=3)
    env.reset(seed=0)
    assert env.agents == env.possible_agents == ["leader_0"]
    decisions = 0
    while env.agents:
        env.step({"leader_0": np.float32([-1, 0])})
        decisions += 1
    assert decisions <= 100
