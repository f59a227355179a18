"""A policy in an ONNX file, executed by ONNX Runtime."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchnav.errors import MissingExtraError

from .network import Float32Array

_ERRORS_ONLY = 3


class OnnxNetwork:
    """The first input is the observation (1, D), the first output the action (1, 2).

    Each further input is a state that an agent remembers, and the outputs after the first one are
    the new states, in the same order; outputs after them are ignored. States begin with 0.

    Agents are executed one by one: within a batch, a library rounds sums differently for batches
    of different sizes, and the commands of an agent would depend on other agents.
    """

    def __init__(self, data: bytes) -> None:
        """Take the content of a file.

        Raises MissingExtraError without ONNX Runtime, and ValueError with a reason if the
        inputs and outputs of the model are others. Damaged files raise errors of the library.
        """
        self._session = _session(data)
        observation, *states = self._session.get_inputs()
        action, *rest = self._session.get_outputs()
        self.inputs = _last(observation)
        for value in (observation, *states, action, *rest[: len(states)]):
            if value.type != "tensor(float)":
                raise ValueError(f"{value.name!r} must hold float32 numbers; got {value.type}")
        if len(rest) < len(states):
            raise ValueError(
                f"it has {len(states)} inputs after the observation, for states:"
                f" {_names(states)}. After the action it must return as many new states;"
                f" it returns {_names(rest) or 'none'}"
            )
        self._names = [value.name for value in (observation, *states)]
        self._outputs = [value.name for value in (action, *rest[: len(states)])]
        self._shapes = [_alone(value) for value in states]
        self.state_size = sum(int(np.prod(shape)) for shape in self._shapes)
        self._check()

    def decide(self, x: Float32Array, state: Float32Array) -> Float32Array:
        action = np.empty((len(x), 2), np.float32)
        for i in range(len(x)):
            first, *states = self._run(x[i : i + 1], state[i])
            action[i] = first
            if states:
                state[i] = np.concatenate([part.reshape(-1) for part in states])
        return action

    def _run(self, x: Float32Array, state: Float32Array) -> list[Any]:
        cuts = np.cumsum([int(np.prod(shape)) for shape in self._shapes])[:-1]
        parts = np.split(state, cuts) if self._shapes else []
        states = [part.reshape(shape) for part, shape in zip(parts, self._shapes, strict=True)]
        answer: list[Any] = self._session.run(
            self._outputs, dict(zip(self._names, [x, *states], strict=True))
        )
        return answer

    def _check(self) -> None:
        """Execute the model once, because a file need not declare the shapes of its outputs."""
        size = np.zeros((1, self.inputs), np.float32)
        action, *states = self._run(size, np.zeros(self.state_size, np.float32))
        if action.shape != (1, 2):
            raise ValueError(
                f"its first output {self._outputs[0]!r} must be the action, of shape (1, 2): speed"
                f" and turn rate. Got the shape {action.shape}"
            )
        for name, state, shape in zip(self._outputs[1:], states, self._shapes, strict=True):
            if state.size != int(np.prod(shape)):
                raise ValueError(
                    f"its output {name!r} must be a new state of shape {shape}. Got {state.shape}"
                )


def _session(data: bytes) -> Any:
    try:
        import onnxruntime
    except ImportError:
        raise MissingExtraError("A policy in an ONNX file", "onnx") from None
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = _ERRORS_ONLY
    return onnxruntime.InferenceSession(data, options, providers=["CPUExecutionProvider"])


def _last(value: Any) -> int:
    size = value.shape[-1] if len(value.shape) == 2 else None
    if not isinstance(size, int):
        raise ValueError(
            f"its first input {value.name!r} must be the observation, of shape (1, D)."
            f" Got the shape {value.shape}"
        )
    return size


def _alone(value: Any) -> tuple[int, ...]:
    """Return the shape of a state of one agent: free axes have length 1."""
    return tuple(size if isinstance(size, int) else 1 for size in value.shape)


def _names(values: Sequence[Any]) -> str:
    return ", ".join(repr(value.name) for value in values)
