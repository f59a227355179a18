import numpy as np
import pytest
import torch
from sb3_contrib import RecurrentPPO
from stable_baselines3 import PPO, SAC, TD3
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import VecFrameStack, VecMonitor, VecNormalize

from benchnav.envs.factory import make_batch
from benchnav.envs.gym.leader_env import LeaderEnv
from benchnav.envs.gym.registration import LEADER
from benchnav.envs.sb3.agent_vec_env import AgentVecEnv
from benchnav.envs.sb3.attempt_monitor import AttemptMonitor
from benchnav.envs.sb3.attempt_ppo import AttemptPPO
from benchnav.errors import UsageError
from tests.envs.recorder import Recorder


@pytest.fixture(autouse=True, scope="module")
def one_thread():
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(before)


def make_env(worlds=2):
    """Two batches: 2 rows of 4 agents, and 1 row of 4 among movers."""
    return AgentVecEnv([
        make_batch("leaders/static", "ego", "train", worlds, None, 8),
        make_batch("leaders/dynamic", "ego", "train", worlds, None, 4),
    ])  # fmt: skip


def actions(env, steps):
    rng = np.random.default_rng(1)
    drawn = rng.uniform(-1, 1, (steps, env.num_envs, 2)).astype(np.float32)
    drawn[:, ::2] = -1, 0
    return drawn


def test_a_recurrent_learner_learns_in_it():
    env = make_env()
    learner = RecurrentPPO(
        "MlpLstmPolicy", env, n_steps=8, batch_size=32, n_epochs=1, seed=0, device="cpu",
        policy_kwargs={"lstm_hidden_size": 8, "net_arch": [8]},
    )  # fmt: skip
    learner.learn(2 * 8 * env.num_envs)
    assert learner.num_timesteps == 2 * 8 * env.num_envs
    assert env.render_mode is None


def test_idle_slots_are_zero_and_never_done():
    env = make_env()
    env.reset()
    idle = np.zeros(env.num_envs, bool)
    woken = 0
    for action in actions(env, 260):
        seen, reward, done, infos = env.step(action)
        active = np.concatenate([batch.active.reshape(-1) for batch in env.batches])
        assert np.array_equal(env.acted, ~idle)
        assert [info["idle"] for info in infos] == idle.tolist()
        assert not seen[~active].any()
        assert not reward[~env.acted].any()
        assert not (done & ~env.acted).any()
        assert np.array_equal(env.woke, idle & active)
        for k in np.flatnonzero(done):
            assert infos[k]["terminal_observation"].shape == env.observation_space.shape
            assert infos[k]["is_success"] == (infos[k]["terms"]["goal"] > 0)
        woken += env.woke.sum()
        idle = ~active
    assert woken > 0


def test_what_it_counts_is_what_happened():
    env = make_env()
    env.reset()
    ended = successes = decisions = 0
    total = 0.0
    for action in actions(env, 260):
        _, reward, _, infos = env.step(action)
        decisions += env.acted.sum()
        total += float(reward.sum())
        ended += sum("is_success" in info for info in infos)
        successes += sum(info.get("is_success", False) for info in infos)
    row = env.tally.take()
    assert (row["decisions"], row["attempts"]) == (decisions, ended)
    assert row["arrived"] * ended == pytest.approx(successes)
    assert row["reward"] * ended == pytest.approx(total, rel=1e-5)
    assert env.tally.take()["attempts"] == 0


def test_a_seed_decides_from_the_next_reset_on():
    env = make_env(worlds=20)
    assert env.seed(1) == list(range(1, 13))
    first = env.reset()
    after = env.step(actions(env, 1)[0])[0]
    env.seed(1)
    assert not np.array_equal(env.step(actions(env, 1)[0])[0], first)  # not before the reset
    assert np.array_equal(env.reset(), first)
    assert np.array_equal(env.step(actions(env, 1)[0])[0], after)
    other = make_env(worlds=20)
    other.seed(np.int64(1))
    assert np.array_equal(other.reset(), first)
    assert not np.array_equal(other.reset(), first)  # goes on in the order that 1 gave
    other.seed(2)
    assert not np.array_equal(other.reset(), first)
    assert len(set(other.seed())) == 12
    assert not np.array_equal(make_env(worlds=20).reset(), make_env(worlds=20).reset())


def test_the_seed_of_a_learner_decides_its_worlds():
    def first(seed):
        model = PPO("MlpPolicy", make_env(worlds=20), n_steps=8, batch_size=96, seed=seed,
                    device="cpu")  # fmt: skip
        model._setup_learn(96)
        return model._last_obs

    assert np.array_equal(first(0), first(0))
    assert not np.array_equal(first(0), first(1))


@pytest.mark.parametrize("policy", [SAC, TD3])
def test_learners_with_a_memory_of_transitions_learn_in_it(policy):
    env = VecMonitor(make_env())
    learner = policy(
        "MlpPolicy", env, learning_starts=24, batch_size=16, device="cpu", seed=0,
        policy_kwargs={"net_arch": [8]},
    )  # fmt: skip
    learner.learn(600)
    ends = learner.replay_buffer.dones[: learner.replay_buffer.pos]
    rewards = learner.replay_buffer.rewards[: learner.replay_buffer.pos]
    assert learner._episode_num == env.episode_count >= ends.sum() > 0
    assert (rewards[ends > 0] != 0).all()


def test_the_wrappers_of_stable_baselines_wrap_it():
    env = VecFrameStack(VecNormalize(VecMonitor(make_env())), 3)
    model = PPO("MlpPolicy", env, n_steps=64, batch_size=64 * 12, n_epochs=1, device="cpu")
    model.learn(64 * 12 * 5)
    assert all(episode["l"] > 0 for episode in model.ep_info_buffer)
    rewards, _ = evaluate_policy(model, env, n_eval_episodes=30, return_episode_rewards=True)
    assert len(rewards) == 30
    assert np.all(rewards)  # an idle stretch would be paid nothing
    env.close()
    env.close()


def test_the_monitor_of_attempts_counts_decisions_and_empties_memories():
    env = make_env()
    recorders, monitor = [Recorder(batch) for batch in env.batches], AttemptMonitor(env)
    monitor.seed(0)
    monitor.reset()
    episodes, idle = [], np.zeros(env.num_envs, bool)
    for action in actions(env, 600):
        _, _, done, infos = monitor.step(action)
        ended = np.array(["episode" in info for info in infos])
        assert np.array_equal(done & env.acted, ended)
        assert np.array_equal(done & ~env.acted, env.woke)
        assert all("terminal_observation" in infos[k] for k in np.flatnonzero(done))
        episodes += [info["episode"] for info in infos if "episode" in info]
        idle |= ~env.acted
    assert idle.any()
    assert monitor.episode_count == len(episodes)
    lengths = sorted(recorders[0].lengths + recorders[1].lengths)
    assert sorted(episode["l"] for episode in episodes) == lengths
    rewards = sorted(recorders[0].rewards + recorders[1].rewards)
    np.testing.assert_allclose(sorted(e["r"] for e in episodes), rewards, rtol=1e-4, atol=1e-4)


def test_recurrent_policies_are_evaluated_in_attempts():
    env = AttemptMonitor(make_env())
    learner = RecurrentPPO("MlpLstmPolicy", env, n_steps=8, batch_size=96, device="cpu",
                           policy_kwargs={"lstm_hidden_size": 8})  # fmt: skip
    learner.learn(96)
    rewards, lengths = evaluate_policy(
        learner, env, n_eval_episodes=14, return_episode_rewards=True
    )
    assert len(rewards) == 14
    assert max(lengths) <= 250


def test_ppo_of_attempts_learns_from_decisions_only(tmp_path):
    env = AttemptMonitor(make_env())
    model = AttemptPPO("MlpPolicy", env, n_steps=300, batch_size=120, n_epochs=1, device="cpu")
    model.learn(300 * 12)
    live = model.rollout_buffer.live
    assert 0 < live.sum() < live.size
    seen = torch.cat([samples.observations for samples in model.rollout_buffer.get(120)])
    assert len(seen) == live.sum()
    assert seen.any(dim=1).all()
    model.save(tmp_path / "model")
    again = AttemptPPO.load(tmp_path / "model", env=make_env(), device="cpu")
    again.learn(300 * 12)
    with pytest.raises(UsageError, match="in an AgentVecEnv"):
        AttemptPPO(
            "MlpPolicy", LeaderEnv(worlds=1, others="orca"), n_steps=8, batch_size=8, device="cpu"
        ).learn(8)


def test_the_factory_of_stable_baselines_makes_single_environments():
    asked = {"scenario": "crowd/circle-crossing", "worlds": 2, "others": "orca"}
    env = make_vec_env(LEADER, 2, env_kwargs=asked, seed=0)
    assert env.reset().shape == (2, 62)
    assert env.render().shape[-1] == 3  # both worlds in one picture
    with pytest.raises(UsageError, match="AttemptMonitor wraps an AgentVecEnv"):
        AttemptMonitor(env)


def test_mistakes_are_explained():
    env = make_env()
    with pytest.raises(UsageError, match=r"call reset\(\)"):
        env.step(actions(env, 1)[0])
    with pytest.raises(UsageError, match=r"0 or more\. Got -1"):
        env.seed(-1)
