"""The part of a policy that turns encoded observations into actions."""

from collections.abc import Callable, Mapping
from typing import Protocol

import numpy as np
import numpy.typing as npt

from ..recurrent_ppo.actor import Actor

Float32Array = npt.NDArray[np.float32]


class Network(Protocol):
    """Actions of agents, each of which depends on its own observations only."""

    @property
    def inputs(self) -> int:
        """The number of values in an observation."""

    @property
    def state_size(self) -> int:
        """The number of values that an agent remembers; they begin with 0."""

    def decide(self, x: Float32Array, state: Float32Array) -> Float32Array:
        """Return actions (N, 2) for observations (N, D); advance ``state`` (N, state_size)."""


def _relu(x: Float32Array) -> Float32Array:
    return np.maximum(x, np.float32(0.0))


def _leaky_relu(x: Float32Array) -> Float32Array:
    return np.where(x > 0.0, x, np.float32(0.01) * x)


def _elu(x: Float32Array) -> Float32Array:
    return np.where(x > 0.0, x, np.expm1(np.minimum(x, np.float32(0.0)))).astype(np.float32)


def _silu(x: Float32Array) -> Float32Array:
    return (x / (np.float32(1.0) + np.exp(-np.maximum(x, np.float32(-80.0))))).astype(np.float32)


ACTIVATIONS: Mapping[str, Callable[[Float32Array], Float32Array]] = {
    "tanh": np.tanh, "relu": _relu, "leaky-relu": _leaky_relu, "elu": _elu, "silu": _silu,
}  # fmt: skip
"""The activations between dense layers, with the defaults of torch."""


class ActorNetwork:
    """The layers of a policy of Stable-Baselines3, with the same bits for every batch."""

    def __init__(self, actor: Actor, squash: bool) -> None:
        """Take the layers; ``squash``: a hyperbolic tangent limits the actions."""
        self._actor, self._squash = actor, squash

    @property
    def inputs(self) -> int:
        first = self._actor.layers[0]
        hidden = len(first.bias) // 4 if self._actor.lstm else 0
        return len(first.weight) - hidden

    @property
    def state_size(self) -> int:
        return self._actor.state_size

    def decide(self, x: Float32Array, state: Float32Array) -> Float32Array:
        action = self._actor.decide(x, state)
        return np.tanh(action) if self._squash else action
