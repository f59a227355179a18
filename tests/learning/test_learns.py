"""A minute of training makes a policy better than it was, by more than chance."""

import numpy as np
import pytest
from benchnav_baselines.learned.recurrent_ppo.actor import Actor
from benchnav_baselines.learned.recurrent_ppo.learning.courses import make_env, training_pools
from benchnav_baselines.learned.recurrent_ppo.learning.evaluate import evaluate
from benchnav_baselines.learned.recurrent_ppo.learning.learner import actor_tensors, make_learner
from benchnav_baselines.learned.recurrent_ppo.learning.recipe import Course, Recipe
from benchnav_baselines.learned.recurrent_ppo.learning.segments import WEIGHTS, Training
from benchnav_baselines.learned.recurrent_ppo.weights import read_weights
from scipy.stats import ttest_rel

from benchnav.envs.agent_batch import AgentBatch
from benchnav.envs.encoders.catalogue import encoder
from benchnav.envs.reward import RewardWeights
from benchnav.generation.build import build
from benchnav.scenario.catalogue import find

RECIPE = Recipe.model_validate(
    {
        "name": "minute",
        "encoder": "surround",
        "courses": [{"scenario": "leaders/static", "worlds": 200}],
        "rows": 32,
        "rollout": 32,
        "network": {"lstm_layers": 0, "dense": [64, 64]},
        "stages": [
            {
                "decisions": 60_000,
                "learning_rate": [1e-3, 3e-4],
                "batch": 512,
                "reward": {"static": 40, "walls": 40, "agents": 40, "moving": "progress"},
            }
        ],
        "checkpoint": 60_000,
        "validation": {"worlds": 2},
    }
)


def success(actor, worlds):
    """(B,) share of each world's agents that arrived untouched."""
    rng, weights = np.random.default_rng(0), RewardWeights()
    arrived = evaluate(actor, AgentBatch(worlds, len(worlds), encoder("surround"), weights, rng))
    return arrived.sum(1) / [len(world.agents) for world in worlds]


def untrained(seed):
    one = RECIPE.model_copy(update={"courses": (Course(scenario="leaders/static", worlds=1),)})
    env = make_env(one, training_pools(one, one.stages[0]))
    return Actor(actor_tensors(make_learner(one, env, seed, "cpu")))


@pytest.mark.slow
def test_training_helps_in_worlds_that_were_never_seen(tmp_path):
    worlds = [build(find("leaders/static"), "validation", k) for k in range(50)]
    Training(RECIPE, 0, tmp_path).run(False, lambda _: None)
    trained, _ = read_weights(tmp_path / WEIGHTS)
    before, after = success(untrained(0), worlds), success(trained, worlds)
    gain = ttest_rel(after, before, alternative="greater")  # worlds are the unit, not agents
    assert after.mean() > before.mean() + 0.1
    assert np.isfinite(gain.pvalue)
    assert gain.pvalue < 1e-3, (before.mean(), after.mean())
