"""Checks what a navigator answered before it may touch the state, and says what went wrong."""

from typing import Any

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray


class CallFailed(Exception):
    """A call of a navigator failed; nobody is charged before it failed for one world alone."""

    def __init__(self, reason: str, suspects: IntArray | None = None) -> None:
        super().__init__(reason)
        self.reason = reason
        self.suspects = suspects  # places in the call that gave garbage; None: cannot be told


def checked(answer: Any, active: BoolArray) -> FloatArray:
    """(B, A, 2) finite float64, zero where not ``active`` (B, A).

    Raises CallFailed where the answer is no such array.
    """
    expected = (*active.shape, 2)
    try:
        command = np.asarray(answer)
    except Exception as error:
        raise CallFailed(f"act must return an array. Got {_name(answer)} instead") from error
    if command.dtype.kind not in "iuf":
        raise CallFailed(f"act must return real numbers. Got {_kind(answer, command)} instead")
    if command.shape != expected:
        raise CallFailed(
            f"act must return an array of shape {expected}. Got shape {command.shape} instead"
        )
    command = np.where(active[..., None], command.astype(np.float64), 0.0)
    finite = np.isfinite(command).all(axis=2)
    if not finite.all():
        world, agent = np.argwhere(~finite)[0]
        got = ", ".join(f"{x:g}" for x in command[world, agent])
        raise CallFailed(
            f"act must return finite numbers. Got ({got}) for agent {agent} instead",
            np.flatnonzero(~finite.all(axis=1)),
        )
    return command


def said(error: BaseException) -> str:
    """What an exception says, on one line of a reason."""
    shown = short(str(error))
    return f"{type(error).__name__}: {shown}" if shown else type(error).__name__


def short(text: str) -> str:
    """On one line, of at most 300 letters."""
    text = " ".join(text.split())
    return text if len(text) <= 300 else text[:297] + "..."


def _name(value: Any) -> str:
    return "None" if value is None else f"a {type(value).__name__}"


def _kind(answer: Any, command: np.ndarray) -> str:
    return f"dtype {command.dtype}" if isinstance(answer, np.ndarray) else _name(answer)
