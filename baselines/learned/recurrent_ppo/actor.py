"""The trained policy's mean action, with the same bits for every batch size and order of agents.

The summation order of a library's matrix product depends on the size of the batch;
here each agent's sums run over the inputs in order. Neither torch nor an extra is needed.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from benchnav.kernels import inlined, kernel_without_allocation

from .activations import exp, tanh

Float32Array = npt.NDArray[np.float32]
_BLOCK = 4  # agents that share a pass over the weights


@dataclass(frozen=True, eq=False)
class Lstm:
    """One LSTM layer; gates in torch's order: input, forget, cell, output."""

    weight: Float32Array  # (D + H, 4 H): of the input, then of the hidden state
    bias: Float32Array  # (4 H,) both of torch's


@dataclass(frozen=True, eq=False)
class Dense:
    """One dense layer."""

    weight: Float32Array  # (D, H)
    bias: Float32Array  # (H,)


class Actor:
    """LSTM layers, dense layers, and a linear output of 2 numbers."""

    def __init__(
        self,
        tensors: Mapping[str, Float32Array],
        activation: Callable[[Float32Array], Float32Array] = np.tanh,
    ) -> None:
        """Take the layers.

        Args:
            tensors: ``lstm{k}.weight``, ``lstm{k}.bias``, ``dense{k}.…``, ``output.…``.
            activation: of the dense layers, element by element.
        """
        self._activation = activation
        self.lstm = [
            Lstm(tensors[f"lstm{k}.weight"], tensors[f"lstm{k}.bias"])
            for k in range(_count(tensors, "lstm"))
        ]
        self.dense = [
            Dense(tensors[f"dense{k}.weight"], tensors[f"dense{k}.bias"])
            for k in range(_count(tensors, "dense"))
        ]
        self.output = Dense(tensors["output.weight"], tensors["output.bias"])

    @property
    def layers(self) -> list[Lstm | Dense]:
        """All layers, from the observation to the action."""
        return [*self.lstm, *self.dense, self.output]

    @property
    def state_size(self) -> int:
        """The number of memory values per agent: hidden and cell state of every layer."""
        return sum(2 * (len(layer.bias) // 4) for layer in self.lstm)

    def decide(self, x: Float32Array, state: Float32Array) -> Float32Array:
        """Return mean actions (N, 2) of observations (N, D); advance ``state`` (N, state_size)."""
        first = 0
        for layer in self.lstm:
            size = len(layer.bias) // 4
            h = state[:, first : first + size]
            gates = affine(np.concatenate([x, h], axis=1), layer.weight, layer.bias)
            x = np.empty((len(x), size), np.float32)
            _cell(gates, state, first, x)
            h[:] = x
            first += 2 * size
        for dense in self.dense:
            x = self._activation(affine(x, dense.weight, dense.bias))
        return affine(x, self.output.weight, self.output.bias)


def _count(tensors: Mapping[str, Float32Array], kind: str) -> int:
    return sum(1 for name in tensors if name.startswith(kind) and name.endswith(".bias"))


def affine(x: Float32Array, weight: Float32Array, bias: Float32Array) -> Float32Array:
    """Return x (N, D) · weight (D, H) + bias (H,): each row summed over D in order."""
    missing = -len(x) % _BLOCK
    padded = np.concatenate([x, np.zeros((missing, x.shape[1]), np.float32)])
    out = np.empty((len(padded), len(bias)), np.float32)
    _affine(np.ascontiguousarray(padded), weight, bias, out)
    return out[: len(x)]


@kernel_without_allocation
def _affine(x: Float32Array, weight: Float32Array, bias: Float32Array, out: Float32Array) -> None:
    for first in range(0, len(x), _BLOCK):
        a, b, c, d = out[first], out[first + 1], out[first + 2], out[first + 3]
        for j in range(len(bias)):
            a[j] = bias[j]
            b[j] = bias[j]
            c[j] = bias[j]
            d[j] = bias[j]
        for k in range(x.shape[1]):
            p, q, r, s = x[first, k], x[first + 1, k], x[first + 2, k], x[first + 3, k]
            row = weight[k]
            for j in range(len(bias)):
                w = row[j]
                a[j] += p * w
                b[j] += q * w
                c[j] += r * w
                d[j] += s * w


@inlined
def _sigmoid(x: np.float32) -> float:
    return 1.0 / (1.0 + float(exp(-x)))


@kernel_without_allocation
def _cell(gates: Float32Array, state: Float32Array, first: int, h: Float32Array) -> None:
    """Set ``h`` (N, H), and advance the cells in the columns ``first`` + H … of ``state``."""
    size = h.shape[1]
    for i in range(len(h)):
        gate, c, out = gates[i], state[i, first + size :], h[i]
        for j in range(size):
            keep = _sigmoid(gate[size + j]) * c[j]
            fresh = _sigmoid(gate[j]) * tanh(gate[2 * size + j])
            c[j] = keep + fresh
            out[j] = _sigmoid(gate[3 * size + j]) * tanh(c[j])
