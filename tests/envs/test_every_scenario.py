"""The loops of the libraries end in every scenario, and count the attempts that there were.

One scenario of each family is tried by `make test`, the others are marked `long`.
"""

import re
from itertools import groupby
from pathlib import Path

import numpy as np
import pytest
from gymnasium.wrappers import RecordEpisodeStatistics
from stable_baselines3 import PPO
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import VecMonitor

from benchnav.envs.factory import make_batch
from benchnav.envs.gym.attempt_statistics import AttemptStatistics
from benchnav.envs.gym.leader_env import LeaderEnv
from benchnav.envs.gym.leader_vector_env import LeaderVectorEnv
from benchnav.envs.parallel_env import LeadersEnv
from benchnav.envs.sb3.agent_vec_env import AgentVecEnv
from benchnav.generation.build import build
from benchnav.scenario.catalogue import find, names
from tests.envs.recorder import Recorder

DOCS = Path(__file__).parents[2] / "docs" / "environments.md"
CHECKS = ("`learn`", "`evaluate_policy`", "Gymnasium's loop", "PettingZoo's loop")


def scenarios():
    for _, family in groupby(names(), lambda name: name.partition("/")[0]):
        first, *others = family
        yield pytest.param(first, marks=pytest.mark.slow)
        yield from (pytest.param(name, marks=pytest.mark.long) for name in others)


every_scenario = pytest.mark.parametrize("name", list(scenarios()))


def hurried(name):
    """The scenario with an early horizon: the others, which plan, are what costs."""
    scenario = find(name)
    clock = scenario.clock
    return scenario.model_copy(
        update={"clock": clock.model_copy(update={"horizon": 64 * clock.dt})}
    )


def learners(name, seed=0):
    return int(build(find(name), "train", seed).agents.evaluated.sum())


def vec_env(name, least=2):
    """Enough rows for two slots at least."""
    slots = -(-least // learners(name)) * learners(name)
    return AgentVecEnv([make_batch(name, "ego", "train", 2, None, slots)])


def learner(env, slots=1, decisions=2048):
    steps = max(decisions // slots, 2)
    return PPO(
        "MlpPolicy", env, n_steps=steps, batch_size=steps * slots, n_epochs=1,
        policy_kwargs={"net_arch": [8]}, seed=0, device="cpu",
    )  # fmt: skip


@every_scenario
def test_stable_baselines_learns_and_evaluates_every_agent(name):
    env = vec_env(name)
    batch = env.batches[0]
    recorder, monitor = Recorder(batch), VecMonitor(env)
    assert env.num_envs == batch.rows * learners(name)
    model = learner(monitor, env.num_envs).learn(2048)
    assert monitor.episode_count == len(recorder.attempts)
    recorder.attempts.clear()
    recorder._going.clear()
    rewards, lengths = evaluate_policy(
        model, monitor, n_eval_episodes=env.num_envs, return_episode_rewards=True
    )
    firsts = {}
    for attempt in recorder.attempts:
        firsts.setdefault((attempt.row, attempt.agent), attempt)
    assert len(firsts) == len(rewards) == env.num_envs
    assert sorted(lengths) == sorted(attempt.length for attempt in firsts.values())
    np.testing.assert_allclose(
        sorted(rewards), sorted(attempt.reward for attempt in firsts.values()), rtol=1e-4, atol=1e-4
    )


@every_scenario
def test_stable_baselines_evaluates_one_agent(name):
    env = RecordEpisodeStatistics(LeaderEnv(name, worlds=2, others="orca"))
    _, lengths = evaluate_policy(
        learner(env), env, n_eval_episodes=2, return_episode_rewards=True, warn=False
    )
    assert list(env.length_queue) == lengths
    assert max(lengths) <= find(name).clock.steps


@pytest.mark.slow
@pytest.mark.parametrize("name", names())
def test_stable_baselines_learns_as_one_agent(name, monkeypatch):
    monkeypatch.setattr("benchnav.envs.factory.find", hurried)
    horizon = hurried(name).clock.steps
    env = RecordEpisodeStatistics(LeaderEnv(name, worlds=2, others="orca"), 10**6)
    decisions = horizon + 256  # so that an attempt ends in any case
    model = learner(env, decisions=decisions).learn(decisions)
    assert env.episode_count == len(model.ep_info_buffer) or env.episode_count > 100
    assert decisions - horizon <= sum(env.length_queue) <= decisions


@every_scenario
def test_the_loop_of_gymnasium_counts_attempts(name):
    envs = AttemptStatistics(LeaderVectorEnv(2 * learners(name), name, worlds=2), 10**6)
    recorder = Recorder(envs.unwrapped.batch)
    envs.reset(seed=0)
    envs.action_space.seed(0)
    successes = 0
    for _ in range(find(name).clock.steps + 20):
        _, _, terminated, truncated, info = envs.step(envs.action_space.sample())
        done = terminated | truncated
        assert not (done & ~info["acted"]).any()
        if done.any():
            assert np.array_equal(info["final_info"]["_is_success"], done)
            successes += info["final_info"]["is_success"][done].sum()
    assert envs.episode_count == len(recorder.attempts) >= envs.num_envs
    assert sorted(envs.length_queue) == recorder.lengths
    np.testing.assert_allclose(sorted(envs.return_queue), recorder.rewards)
    assert successes == sum(attempt.success for attempt in recorder.attempts)


@every_scenario
def test_the_loop_of_pettingzoo_ends(name):
    env = LeadersEnv(name, "ego", worlds=2)
    recorder = Recorder(env.batch)
    seen, infos = env.reset(seed=0)
    assert env.agents == [f"leader_{a}" for a in range(learners(name, infos["leader_0"]["world"]))]
    assert set(env.agents) <= set(env.possible_agents)
    began, ended, decisions = set(env.agents), [], 0
    for agent in env.agents:
        env.action_space(agent).seed(0)
    while env.agents:
        agents = list(env.agents)
        seen, rewards, terminated, truncated, infos = env.step(
            {agent: env.action_space(agent).sample() for agent in agents}
        )
        for part in (seen, rewards, terminated, truncated, infos):
            assert list(part) == agents
        ended += [agent for agent in agents if terminated[agent] or truncated[agent]]
        decisions += 1
    assert set(ended) == began
    assert len(ended) == len(began) == len(recorder.attempts)
    assert decisions == recorder.lengths[-1] <= find(name).clock.steps


def test_the_table_of_the_docs_names_every_scenario():
    rows = re.findall(r"^\| `(\S+)` \| (.*) \|$", DOCS.read_text(), re.MULTILINE)
    table = {name: cells.split(" | ") for name, cells in rows if "/" in name}
    assert table == {name: row_of(name) for name in names()}


def row_of(name):
    """Cells of the table: who learns in a world, its decisions, and what the tests above try."""
    scenario = find(name)
    world = build(scenario, "train", 0)
    ticks = ["✓"] * len(CHECKS)
    return [f"{learners(name)} of {len(world.agents)}", str(scenario.clock.steps), *ticks]


if __name__ == "__main__":
    print("| scenario | learning agents | decisions |", " | ".join(CHECKS), "|")
    print("|---|---|---|" + "---|" * len(CHECKS))
    for name in names():
        print(f"| `{name}` |", " | ".join(row_of(name)), "|")
