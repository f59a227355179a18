"""The result of training: a value for every tried move in every visited situation."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchnav.arrays import AnyArray, FloatArray, IntArray
from benchnav.errors import PluginError

from ...common.tensor_file import TensorFile, read_tensors, write_tensors
from .encoder import ENCODER, SITUATIONS
from .learner import Learner
from .moves import MOVES

_UNKNOWN = len(MOVES) - 1  # in a situation without a value: turn in place


@dataclass(frozen=True, eq=False)
class Table:
    """The values of the M visited situations."""

    situation: IntArray  # (M,) ascending
    values: FloatArray  # (M, U), float32 in the file; -inf: never tried
    about: dict[str, str]  # encoder, moves, seed, steps, seconds

    @classmethod
    def of(cls, learner: Learner, **about: object) -> "Table":
        """Return the learned values, with facts ``about`` the training."""
        met = np.flatnonzero(learner.visits.any(axis=1))
        values = np.where(learner.visits[met] > 0, learner.values[met], -np.inf)
        facts = {"encoder": ENCODER, "moves": _moves(), **about}
        rounded = values.astype(np.float32).astype(np.float64)
        return cls(met.astype(np.int64), rounded, {k: str(v) for k, v in facts.items()})

    def policy(self) -> IntArray:
        """Return the best move (S,) of every situation."""
        best = np.full(SITUATIONS, _UNKNOWN)
        best[self.situation] = self.values.argmax(axis=1)
        return best


def save(path: Path, table: Table) -> None:
    """Write a table as a safetensors file."""
    arrays = {
        "situation": table.situation.astype(np.int32),
        "values": table.values.astype(np.float32),
    }
    write_tensors(path, arrays, dict(sorted(table.about.items())))


def load(path: Path) -> Table:
    """Return the table in a file.

    Raises:
        PluginError: there is none, it is truncated, or it is of another kind.
    """
    file = read_tensors(path)
    _check_facts(path, file.about)
    situation = _array(path, file, "situation", np.int32).astype(np.int64)
    values = _array(path, file, "values", np.float32).astype(np.float64)
    _check(path, situation, values)
    return Table(situation, values, {**file.about, "sha256": file.sha256})


def _moves() -> str:
    return json.dumps(MOVES.tolist())


def _wrong(path: Path, got: str) -> PluginError:
    return PluginError(
        "The table of q-learning must be a file that"
        f" 'benchnav train' wrote with the trainer q-learning. Got {got}: {path}."
    )


def _check_facts(path: Path, about: Mapping[str, str]) -> None:
    """Raise PluginError unless the metadata is of this encoder and these moves."""
    for name, expected in (("encoder", ENCODER), ("moves", _moves())):
        if about.get(name) != expected:
            raise _wrong(path, f"the {name} {about.get(name)!r} instead of {expected!r}")


def _array(path: Path, file: TensorFile, name: str, kind: type) -> AnyArray:
    array = file.tensors.get(name)
    if array is None or array.dtype != kind:
        got = "no such array" if array is None else str(array.dtype)
        raise _wrong(path, f"{got} where {name!r} should be {np.dtype(kind)}")
    return array


def _check(path: Path, situation: IntArray, values: FloatArray) -> None:
    if situation.ndim != 1 or values.shape != (len(situation), len(MOVES)):
        raise _wrong(path, f"arrays of shape {situation.shape} and {values.shape}")
    rising = bool((np.diff(situation) > 0).all())
    inside = len(situation) == 0 or (situation[0] >= 0 and situation[-1] < SITUATIONS)
    if not (rising and inside):
        raise _wrong(path, f"situations that do not rise within 0 … {SITUATIONS - 1}")
    if np.isnan(values).any():
        raise _wrong(path, "values that are not numbers")
