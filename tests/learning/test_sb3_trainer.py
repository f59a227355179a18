"""The algorithms of Stable-Baselines3 and sb3-contrib learn from recipes and scripts, and rank."""

import numpy as np
import pytest
import torch
import yaml
from sb3_contrib import RecurrentPPO
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.vec_env import VecMonitor

import benchnav
from benchnav.envs import LiveReplayBuffer
from benchnav.errors import ScenarioError, UsageError
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import NAVIGATORS

HYPERPARAMETERS = {
    "PPO": {"n_steps": 8, "batch_size": 32, "learning_rate": [1e-3, 1e-4]},
    "A2C": {"n_steps": 8},
    "TRPO": {"n_steps": 8, "batch_size": 32},
    "RecurrentPPO": {"n_steps": 8, "batch_size": 32},
    "SAC": {"learning_starts": 20, "buffer_size": 500},
    "TQC": {"learning_starts": 20, "buffer_size": 500},
    "TD3": {"learning_starts": 20, "buffer_size": 500, "action_noise": 0.1},
    "DDPG": {"learning_starts": 20, "buffer_size": 500},
}


def recipe(algorithm="PPO", **changes):
    network = {"dense": [8]} | ({"lstm_size": 8} if algorithm == "RecurrentPPO" else {})
    return {
        "name": "tiny", "trainer": "sb3-algorithm", "algorithm": algorithm, "network": network,
        "hyperparameters": HYPERPARAMETERS.get(algorithm, {}),
        "courses": [{"scenario": "leaders/static", "worlds": 3, "rows": 2}],
        "decisions": 120, "checkpoint": 60, "validation": {"worlds": 1}, **changes,
    }  # fmt: skip


def trained(folder, *args, seed=0, **changes):
    return benchnav.train(recipe(*args, **changes), out=folder, seed=seed, quiet=True)


@pytest.mark.slow
@pytest.mark.parametrize("algorithm", HYPERPARAMETERS)
def test_every_algorithm_makes_a_navigator(tmp_path, algorithm):
    done = trained(tmp_path, algorithm)
    assert done.weights == tmp_path / "policy.zip"
    navigator = make(NAVIGATORS, {"type": "policy", "file": str(done.weights)})
    facts = yaml.safe_load(done.weights.with_suffix(".yaml").read_text())
    assert facts["encoder"] == "ego"
    assert navigator.training.decisions == facts["decisions"] >= 120
    assert len(list((tmp_path / "checkpoints").glob("*.zip"))) == 2
    assert (tmp_path / "curve.csv").read_text().count("\n") == 3


@pytest.mark.slow
def test_a_training_is_its_recipe_and_seed(tmp_path):
    first, again, other = (
        trained(tmp_path / name, seed=seed) for name, seed in (("a", 1), ("b", 1), ("c", 2))
    )
    weights = [PPO.load(done.weights).get_parameters()["policy"] for done in (first, again, other)]
    same, differ = zip(*((weights[0][k] == weights[1][k], weights[0][k] != weights[2][k])
                         for k in weights[0]), strict=True)  # fmt: skip
    assert all(bool(x.all()) for x in same)
    assert any(bool(x.any()) for x in differ)
    with pytest.raises(UsageError, match="must be a new folder"):
        trained(tmp_path / "a")
    with pytest.raises(UsageError, match="cannot resume"):
        benchnav.train(recipe(), out=tmp_path / "a", resume=True, quiet=True)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"algorithm": "PP0"}, "Did you mean 'PPO'"),
        ({"algorithm": "DQN"}, "must be one of A2C, DDPG, PPO, RecurrentPPO"),
        ({"encoder": "egoo"}, "Did you mean 'ego'"),
        ({"network": {"lstm_size": 8}}, "is for RecurrentPPO; PPO has no memory"),
        ({"hyperparameters": {"n_step": 8}}, "PPO has no hyperparameter 'n_step'"),
        ({"hyperparameters": {"env": "x"}}, "PPO has no hyperparameter 'env'"),
        ({"hyperparameters": {"n_steps": 8.5}}, "'n_steps' must be a whole number. Got 8.5"),
        ({"hyperparameters": {"n_steps": True}}, "'n_steps' must be a whole number. Got True"),
        ({"hyperparameters": {"gamma": "much"}}, "'gamma' must be a number. Got 'much'"),
        ({"hyperparameters": {"learning_rate": "fast"}}, "must be a number, or [first, last]"),
        ({"hyperparameters": {"n_steps": 1, "batch_size": 1}}, "PPO refuses its hyperparameters"),
    ],
)
def test_a_mistake_in_a_recipe_is_explained_before_the_training(tmp_path, changes, message):
    changes = {"courses": [{"scenario": "crowd/circle-crossing", "worlds": 1, "rows": 1}]} | changes
    with pytest.raises((ScenarioError, UsageError)) as refused:
        trained(tmp_path, **changes)
    assert message in str(refused.value)
    assert not (tmp_path / "policy.zip").exists()


def test_a_replay_buffer_keeps_decisions_only():
    env = benchnav.make_env("leaders/static", kind="sb3", worlds=2, num_worlds=1)
    learner = SAC(
        "MlpPolicy", env, learning_starts=10**6, buffer_size=1000, seed=0, device="cpu",
        replay_buffer_class=LiveReplayBuffer, policy_kwargs={"net_arch": [4]},
    )  # fmt: skip
    learner.learn(240)
    buffer, decisions = learner.replay_buffer, env.unwrapped.tally.counts["decisions"]
    assert buffer.size() == decisions < 240
    assert np.abs(buffer.observations[:decisions]).sum(-1).min() > 0  # idle slots observe zeros


def stock(folder, decisions):
    """Policies that stock learners of both libraries trained in an environment of benchnav."""
    torch.set_num_threads(1)
    env = benchnav.make_env("leaders/static", kind="sb3", encoder="surround", worlds=50,
                            num_worlds=4, reward={"moving": "progress"})  # fmt: skip
    small = {"net_arch": [16], "lstm_hidden_size": 16}
    learners = {
        "ppo": PPO("MlpPolicy", env, n_steps=16, batch_size=128, n_epochs=4, seed=0),
        "recurrent": RecurrentPPO(
            "MlpLstmPolicy",
            VecMonitor(env.unwrapped),
            n_steps=16,
            n_epochs=2,
            seed=0,
            policy_kwargs=small,
        ),
    }
    for name, learner in learners.items():
        learner.learn(decisions)
        learner.save(folder / name)
    return {name: {"type": "policy", "file": str(folder / f"{name}.zip"), "label": name}
            for name in learners}  # fmt: skip


def ranked(folder, navigators, seeds):
    suite = {
        "name": "mine", "version": 1, "scenarios": ["leaders/static"], "tracks": ["unknown"],
        "navigators": [*navigators.values(), "random-walk"], "seeds": seeds,
    }  # fmt: skip
    run = benchnav.run(suite, out=folder / "run", quiet=True)
    assert run.verify(quiet=True, twin=1).verified
    return run.leaderboard()


@pytest.mark.slow
def test_stock_learners_train_and_rank(tmp_path):
    table = str(ranked(tmp_path, stock(tmp_path, 200), seeds=1))
    assert "ppo" in table
    assert "recurrent" in table


@pytest.mark.soak
def test_stock_learners_that_train_for_a_minute_beat_chance(tmp_path):
    navigators = stock(tmp_path, 100_000)
    ranked(tmp_path, navigators, seeds=25)
    for name in navigators:
        mine, chance = success(tmp_path / "run", name), success(tmp_path / "run", "random-walk")
        assert mine > chance + 0.2, (name, mine, chance)


def success(run, navigator):
    """The share of agents that succeeded."""
    frame = benchnav.open_run(run).leaderboard(metrics="success").to_pandas()
    rows = frame[(frame.navigator == navigator) & frame.scenario.str.startswith("leaders/static")]
    return rows.value.item()
