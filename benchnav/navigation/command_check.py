"""Check the answers of a navigator before they reach the state, and describe its failures."""

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from itertools import islice
from typing import Any

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.navigation.plugin.trace import class_name, location, plain
from benchnav.text.visible import shortened

_PLACE = re.compile(r" (\([^()]+:\d+\))\.?$")
MOST_REMARKS = 20  # stored per episode
_NUMBER = re.compile(r"-?\d[\d.]*(e[-+]?\d+)?")
_TIME = re.compile(r" at t = \S+ s$")


class CallFailed(Exception):
    """A call of a navigator failed; it is charged once it failed for a single world."""

    def __init__(self, reason: str, suspects: IntArray | None = None, traceback: str = "") -> None:
        super().__init__(reason)
        self.reason = reason
        self.traceback = traceback  # as text; "" if nothing was raised
        self.suspects = suspects  # batch indices of worlds with invalid commands; None: unknown


def checked(answer: Any, active: BoolArray) -> FloatArray:
    """Return the commands (B, A, 2), finite float64, zero for agents not ``active`` (B, A).

    Raises CallFailed if the answer is not an array of finite numbers of this shape.
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
    if command.dtype == np.float64:
        command = command.copy(order="C")
    else:
        with np.errstate(over="ignore"):  # a number that float64 cannot hold is not finite
            command = np.array(command, np.float64, order="C")
    if not active.all():
        command[~active] = 0.0
    if not np.isfinite(command).all():
        finite = np.isfinite(command).all(axis=2)
        world, agent = np.argwhere(~finite)[0]
        got = ", ".join(f"{x:g}" for x in command[world, agent])
        raise CallFailed(
            f"act must return finite numbers. Got ({got}) for agent {agent} instead",
            np.flatnonzero(~finite.all(axis=1)),
        )
    return command


def exception_text(error: BaseException) -> str:
    """Return the text of an exception and where it was raised, on one line."""
    name, text, place = class_name(error), short(error), location(error)
    return (f"{name}: {text}" if text else name) + (f" ({place})" if place else "")


def short(text: object) -> str:
    """Return an object as text on one line, of at most 300 characters."""
    return shortened(" ".join(plain(text).split()), 300)


def remarks_of(answer: Any) -> list[str]:
    """Return the remarks in a navigator's answer: a string is one remark, None means no remarks."""
    if answer is None:
        return []
    given = [answer] if isinstance(answer, str) else islice(answer, MOST_REMARKS)
    return [short(remark) for remark in given]


def kind_of(reason: str) -> str:
    """Return the kind of a reason: reasons that differ only in numbers and times are of one kind.

    If a reason names a line of code, only the exception and that line count.
    """
    reason = _TIME.sub("", reason)
    place = _PLACE.search(reason)
    return reason.partition(": ")[0] + place[1] if place else _NUMBER.sub("#", reason)


def one_of_each_kind(reasons: Iterable[str]) -> list[str]:
    """Return the first reason of each kind, so that a world counts once for reasons of one kind."""
    first: dict[str, str] = {}
    for reason in reasons:
        first.setdefault(kind_of(reason), reason)
    return list(first.values())


def grouped(reasons: Mapping[str, int]) -> list[tuple[str, int]]:
    """Return (reason, count) of each kind, most frequent first; reasons omit the time."""
    kinds: dict[str, Counter[str]] = {}
    for reason, count in reasons.items():
        kinds.setdefault(kind_of(reason), Counter())[_TIME.sub("", reason)] += count
    found = [(texts.most_common(1)[0][0], texts.total()) for texts in kinds.values()]
    return sorted(found, key=lambda group: (-group[1], group[0]))


def _name(value: Any) -> str:
    return "None" if value is None else f"a {class_name(value)}"


def _kind(answer: Any, command: np.ndarray) -> str:
    return f"dtype {short(command.dtype)}" if isinstance(answer, np.ndarray) else _name(answer)
