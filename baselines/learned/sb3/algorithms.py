"""The algorithms, with hyperparameters that are checked before a training begins."""

import inspect
from numbers import Real
from typing import Any

import numpy as np
import sb3_contrib
import stable_baselines3
import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.noise import NormalActionNoise
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm
from stable_baselines3.common.on_policy_algorithm import OnPolicyAlgorithm

from benchnav.envs import AgentVecEnv, LiveBuffer, LiveReplayBuffer
from benchnav.errors import UsageError, did_you_mean

from .live_recurrent_buffer import LiveRecurrentBuffer
from .recipe import RECURRENT, Network, Recipe, Value

RESERVED = frozenset({
    # set by the trainer or by other keys of the recipe
    "self", "policy", "env", "seed", "device", "verbose", "tensorboard_log", "policy_kwargs",
    "stats_window_size", "_init_setup_model", "rollout_buffer_class", "rollout_buffer_kwargs",
    "replay_buffer_class", "replay_buffer_kwargs", "optimize_memory_usage", "use_sde",
    "sde_sample_freq", "use_sde_at_warmup", "n_steps_replay",
})  # fmt: skip
_ACTIVATIONS = {
    "tanh": torch.nn.Tanh, "relu": torch.nn.ReLU, "leaky-relu": torch.nn.LeakyReLU,
    "elu": torch.nn.ELU, "silu": torch.nn.SiLU,
}  # fmt: skip
_NOISE = "action_noise"
_RATE = "learning_rate"


class LinearRate:
    """A learning rate that changes linearly with the share of the training that is done.

    Stable-Baselines3 saves it with the policy, so it holds numbers only.
    """

    def __init__(self, first: float, last: float) -> None:
        self.first, self.last, self.done = first, last, 0.0

    def __call__(self, remaining: float) -> float:
        """Return the rate now; ``remaining`` counts idle steps too and is ignored."""
        return self.first + (self.last - self.first) * min(self.done, 1.0)


def algorithm_class(name: str) -> type[BaseAlgorithm]:
    """Return the class of an algorithm."""
    library = stable_baselines3 if hasattr(stable_baselines3, name) else sb3_contrib
    found: type[BaseAlgorithm] = getattr(library, name)
    return found


def make_learner(recipe: Recipe, env: Any, seed: int, device: str) -> BaseAlgorithm:
    """Return a new learner in ``env``, an `AgentVecEnv` or a wrapper of one.

    Raises UsageError for a hyperparameter that the algorithm does not have, or that it refuses.
    """
    kind = algorithm_class(recipe.algorithm)
    options = _hyperparameters(recipe, kind)
    buffer: dict[str, Any] = {}
    if issubclass(kind, OffPolicyAlgorithm):
        buffer = {"replay_buffer_class": LiveReplayBuffer}
    elif recipe.algorithm != RECURRENT:
        buffer = {"rollout_buffer_class": LiveBuffer}
    policy = "MlpLstmPolicy" if recipe.algorithm == RECURRENT else "MlpPolicy"
    try:
        learner = kind(
            policy, env, policy_kwargs=_policy_options(recipe.network), seed=seed, device=device,
            **options, **buffer,
        )  # fmt: skip
    except (AssertionError, TypeError, ValueError) as error:
        raise UsageError(
            f"The recipe {recipe.name!r}: {recipe.algorithm} refuses its hyperparameters:"
            f" {' '.join(str(error).split())[:300]}"
        ) from None
    if isinstance(learner, OnPolicyAlgorithm):
        _watch_idle_slots(learner, env.unwrapped)
    return learner


def _watch_idle_slots(learner: OnPolicyAlgorithm, env: AgentVecEnv) -> None:
    """Give a learner rollouts that distinguish decisions from idle steps."""
    stock: Any = learner.rollout_buffer
    if not isinstance(stock, LiveBuffer):
        learner.rollout_buffer = LiveRecurrentBuffer(
            learner.n_steps, learner.observation_space, learner.action_space,
            stock.hidden_state_shape, learner.device, gamma=learner.gamma,
            gae_lambda=learner.gae_lambda, n_envs=learner.n_envs,
        )  # fmt: skip
    buffer: Any = learner.rollout_buffer
    buffer.env = env


def _policy_options(network: Network) -> dict[str, Any]:
    activation = _ACTIVATIONS[network.activation] if network.activation else None
    options = {
        "net_arch": None if network.dense is None else list(network.dense),
        "activation_fn": activation,
        "lstm_hidden_size": network.lstm_size,
        "n_lstm_layers": network.lstm_layers,
    }
    return {name: value for name, value in options.items() if value is not None}


def _hyperparameters(recipe: Recipe, kind: type[BaseAlgorithm]) -> dict[str, Any]:
    parameters = inspect.signature(kind.__init__).parameters
    known = {name: p.default for name, p in parameters.items() if name not in RESERVED}
    options: dict[str, Any] = {}
    for name, value in recipe.hyperparameters.items():
        if name not in known:
            raise UsageError(
                f"The recipe {recipe.name!r}: {recipe.algorithm} has no hyperparameter {name!r}."
                f" It has {', '.join(known)}.{did_you_mean(name, known)}"
            )
        expected = _expected(name, value, known[name])
        if expected:
            raise UsageError(
                f"The recipe {recipe.name!r}: the hyperparameter {name!r} must be {expected}."
                f" Got {value!r} instead."
            )
        options[name] = _converted(name, value)
    return options


def _expected(name: str, value: Value, default: Any) -> str:
    """Return the kind of value that a hyperparameter takes if ``value`` is another; else ""."""
    number = isinstance(value, Real) and not isinstance(value, bool)
    if name == _NOISE:
        return "" if number else "a number, the standard deviation of the noise"
    if name == _RATE:
        return "" if number or isinstance(value, tuple) else "a number, or [first, last]"
    if isinstance(default, bool):
        return "" if isinstance(value, bool) else "true or false"
    if isinstance(default, int):
        whole = isinstance(value, int) and not isinstance(value, bool)
        return "" if whole else "a whole number"
    if isinstance(default, float):
        return "" if number else "a number"
    if isinstance(value, tuple):
        return "one value"
    return ""


def _converted(name: str, value: Any) -> Any:
    if name == _NOISE:
        return NormalActionNoise(np.zeros(2), np.full(2, float(value)))
    if isinstance(value, tuple):
        return LinearRate(*value)
    return value
