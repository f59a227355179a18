"""Training: decisions a second of the recipe `dynamic` in `leaders/dynamic`, two processes.

Actor and critic have two LSTM layers of 128 each. Collection and learning are timed, after one
update; building worlds and validation are not. The peer is RecurrentPPO of sb3-contrib, as it is,
in the same environment with the same network and settings. It learns from idle transitions too;
only decisions of active attempts count for both. It has as many threads as processes here.
"""

import sys
from functools import cache, partial
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.pair import NotMeasuredError, Pair
from benchnav.threads import core_count

if TYPE_CHECKING:
    from benchnav_baselines.learned.recurrent_ppo.learning.learner_group import LearnerGroup

WORLDS, UPDATES, PROCESSES = 150, 4, 2
FACTOR = 6.0  # to reach, of the peer's rate
RATES = {"bfloat16": 9e3, "float32": 6.5e3}  # to reach, decisions per second
LIMIT = "The products of the LSTMs take most of the time."


def pairs() -> list[Pair]:
    """Return the pair with the peer, and one of each precision with the yardstick."""
    name = f"training, LSTM 2 × 128, {PROCESSES} processes"
    return [
        Pair(
            name=f"{name} against sb3-contrib", unit="decisions/s", ours=partial(rate, "auto"),
            theirs=stock_rate, peer="RecurrentPPO of sb3-contrib", wanted=FACTOR, blocks=1,
            warm=False, limit=LIMIT,
        ),
        *(
            Pair(
                name=f"{name}, {precision}", unit="decisions/s", ours=partial(rate, precision),
                wanted=wanted, blocks=2, warm=False, limit=LIMIT,
            )
            for precision, wanted in RATES.items()
        ),
    ]  # fmt: skip


def rate(precision: str, processes: int = PROCESSES) -> float:
    """Return decisions a second of benchnav's learner."""
    _require_learner()
    from benchnav_baselines.learned.recurrent_ppo.learning.learner_group import learner_group

    if core_count() < processes:
        raise NotMeasuredError(f"{processes} processes need as many cores; there are less")
    with learner_group(processes, learn, precision) as group:
        return learn(group, precision)


def learn(group: "LearnerGroup", precision: str) -> float:
    """Learn as one of a group; return the decisions a second of all."""
    import torch
    from benchnav_baselines.learned.recurrent_ppo.learning.courses import make_env
    from benchnav_baselines.learned.recurrent_ppo.learning.learner import (
        SequencePPO,
        enter,
        make_learner,
        native_precision,
        reseed,
        set_precision,
    )

    recipe, pools = _recipe()
    torch.set_num_threads(1)
    env = make_env(recipe, pools, group.share(recipe.rows))
    learner = make_learner(recipe, env, 0, "cpu")
    assert isinstance(learner, SequencePPO)
    learner.join(group)
    chosen: Any = native_precision(learner.device) if precision == "auto" else precision
    set_precision(learner, chosen)
    env.enter(recipe.stages[0].reward, group.rank)
    reseed(learner, np.random.default_rng(group.rank))
    enter(learner, recipe.stages[0], 0.0)
    seconds, decisions = _updates(learner, env)
    return sum(group.gather(decisions)) / seconds


def stock_rate() -> float:
    """Return decisions a second of sb3-contrib's own class."""
    _require_learner()
    import torch
    from benchnav_baselines.learned.recurrent_ppo.learning.courses import make_env
    from sb3_contrib import RecurrentPPO

    recipe, pools = _recipe()
    torch.set_num_threads(PROCESSES)
    env = make_env(recipe, pools)
    stage, network = recipe.stages[0], recipe.network
    env.enter(stage.reward, 0)
    learner = RecurrentPPO(
        "MlpLstmPolicy", env, n_steps=recipe.rollout, batch_size=stage.batch, seed=0,
        n_epochs=stage.epochs, learning_rate=stage.learning_rate[0], device="cpu",
        policy_kwargs={"net_arch": [], "lstm_hidden_size": network.lstm_size,
                       "n_lstm_layers": network.lstm_layers},
    )  # fmt: skip
    seconds, decisions = _updates(learner, env, 1)
    return decisions / seconds


def _updates(learner: Any, env: Any, updates: int = UPDATES) -> tuple[float, int]:
    """Return the seconds and decisions of ``updates`` updates, after a first one."""
    _, callback = learner._setup_learn(sys.maxsize, None)
    began, first = 0.0, 0
    for update in range(1 + updates):
        if update == 1:
            began, first = perf_counter(), env.tally.counts["decisions"]
        learner.collect_rollouts(env, callback, learner.rollout_buffer, learner.n_steps)
        learner.train()
    return perf_counter() - began, int(env.tally.counts["decisions"]) - first


@cache
def _recipe() -> tuple[Any, Any]:
    """Return the recipe, and its worlds."""
    from benchnav_baselines.learned.recurrent_ppo.learning.courses import training_pools
    from benchnav_baselines.learned.recurrent_ppo.learning.recipe import Course, Recipe

    from benchnav.config.yaml_reader import read_yaml, validate
    from benchnav.envs.recipes import recipe_files

    recipe = validate(Recipe, read_yaml(recipe_files()[0]["dynamic"].path))
    courses = (Course(scenario="leaders/dynamic", worlds=WORLDS),)
    recipe = recipe.model_copy(update={"courses": courses})
    return recipe, training_pools(recipe, recipe.stages[0])


def _require_learner() -> None:
    try:
        import sb3_contrib  # noqa: F401
    except ImportError as error:
        raise NotMeasuredError(f"the extra 'learn' is not installed ({error.name})") from None
