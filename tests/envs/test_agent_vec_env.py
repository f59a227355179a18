import numpy as np
import pytest
from sb3_contrib import RecurrentPPO

from benchnav.envs.agent_vec_env import AgentVecEnv
from benchnav.envs.making import make_batch


def make_env():
    """Two batches: 2 rows of 4 agents, and 1 row of 4 among movers."""
    return AgentVecEnv([
        make_batch("leaders/static", "ego", "train", 2, None, 8),
        make_batch("leaders/dynamic", "ego", "train", 2, None, 4),
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


def test_idle_slots_are_zero_and_done_when_their_row_restarts():
    env = make_env()
    env.reset()
    idle = np.zeros(env.num_envs, bool)
    woken = 0
    for action in actions(env, 260):
        seen, reward, done, infos = env.step(action)
        active = np.concatenate([batch.active.reshape(-1) for batch in env.batches])
        assert np.array_equal(env.acted, ~idle)
        assert not seen[~active].any()
        assert not reward[~env.acted].any()
        woke = idle & active
        assert np.array_equal(done & ~env.acted, woke)
        assert all(infos[k] == {"idle": True} for k in np.flatnonzero(woke))
        for k in np.flatnonzero(done & env.acted):
            assert not infos[k]["idle"]
            assert infos[k]["terminal_observation"].shape == env.observation_space.shape
        woken += woke.sum()
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
