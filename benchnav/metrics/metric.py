"""A metric: a pure function of an episode, with unit, direction, range and reference."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType
from typing import Any, Literal

import numpy as np

from benchnav.arrays import LARGEST, BoolArray, FloatArray
from benchnav.episode.episode import Episode

OWN = "own definition"
NOT_APPLICABLE = "n/a: "
"""Begins the reason of a missing value that no failure caused; leaderboards show it as such."""
Direction = Literal["higher", "lower"]
Scope = Literal["agent", "group"]
Function = Callable[..., FloatArray | float]
"""Per agent: ``(episode) -> (A,)``; per group: ``(episode, members) -> float``."""


@dataclass(frozen=True, kw_only=True)
class Metric:
    """A function of an episode, with the properties that tables need. A call calls the function.

    An undefined value is NaN, never a perfect score. `metric` converts a function into a metric.
    """

    name: str  # "success", "path_length", …
    title: str  # one sentence
    unit: str  # "", "m", "s", "rad/m", …
    better: Direction | None  # None: descriptive, never ranked
    low: float  # smallest and largest possible value
    high: float
    reference: str  # source of the definition
    function: Function
    scope: Scope = "agent"
    conditional: bool = False  # defined only for agents that arrive: shows n, never ranks
    verifiable: bool = True  # False for timings
    rate: bool = False  # 0 or 1 per agent: it has a binomial interval
    people: bool = False  # of people around the agents: not applicable in a world without any
    undisturbed: bool = False  # compares with `Episode.undisturbed`: not applicable without it

    def __post_init__(self) -> None:
        object.__setattr__(self, "__doc__", self.function.__doc__)  # for `help`

    def __call__(self, *arguments: Any) -> Any:
        return self.function(*arguments)


def metric(
    *,
    title: str,
    unit: str,
    better: Direction | None,
    low: float = -math.inf,
    high: float = math.inf,
    reference: str = OWN,
    scope: Scope = "agent",
    conditional: bool = False,
    verifiable: bool = True,
    rate: bool = False,
    people: bool = False,
    undisturbed: bool = False,
) -> Callable[[Function], Metric]:
    """Return a decorator that converts a function into a `Metric` with the function's name.

    Its arguments are the fields of `Metric`. The function of an agent's metric takes the episode
    and returns (A,); that of a group's metric also takes the members (A,), and returns a number.
    """

    def decorate(function: Function) -> Metric:
        return Metric(
            name=function.__name__, title=title, unit=unit, better=better, low=low, high=high,
            reference=reference, function=function, scope=scope, conditional=conditional,
            verifiable=verifiable, rate=rate, people=people,
            undisturbed=undisturbed,
        )  # fmt: skip

    return decorate


def metrics_in(module: ModuleType) -> dict[str, str]:
    """Return {metric: attribute} of the metrics that a module defines; imported ones are not."""
    return {
        thing.name: attribute
        for attribute, thing in vars(module).items()
        if isinstance(thing, Metric)
        and getattr(thing.function, "__module__", "") == module.__name__
    }


def _mean(values: FloatArray) -> float:
    """Return ``values.mean()``; for floats, its own sum and division without its other work."""
    if values.dtype != np.float64 or values.ndim != 1:
        return float(values.mean())
    return float(np.add.reduce(values)) / len(values)


def evaluate(metric: Metric, episode: Episode, members: BoolArray) -> tuple[float, int]:
    """Return the mean over the members (A,) with a defined value, and their number.

    Raises ValueError if the magnitude of the mean exceeds `LARGEST`.
    """
    if metric.scope == "group":
        value = float(metric.function(episode, members))
        defined = int(value == value)
    else:
        values = metric.function(episode)[members]  # type: ignore[index]
        known = values[values == values]
        value, defined = (_mean(known) if len(known) else float("nan")), len(known)
    if abs(value) > LARGEST:
        raise ValueError(f"a metric must be from {-LARGEST:g} to {LARGEST:g}; got {value:g}")
    return value, defined
