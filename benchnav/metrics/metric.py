"""A metric: a pure function of an episode, with unit, direction, range and reference."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from benchnav.arrays import LARGEST, BoolArray, FloatArray
from benchnav.episode.episode import Episode


@dataclass(frozen=True)
class Metric:
    """Per agent: ``function(episode) -> (A,)``; per group: ``function(episode, members) -> float``.

    Undefined is NaN, never a perfect score.
    """

    name: str  # "success", "path_length", …
    title: str  # one sentence
    unit: str  # "", "m", "s", "rad/m", …
    better: Literal["higher", "lower"] | None  # None: descriptive, never ranked
    low: float  # smallest and greatest possible value
    high: float
    reference: str  # where the definition comes from
    function: Callable[..., FloatArray | float]
    scope: Literal["agent", "group"] = "agent"
    conditional: bool = False  # defined only for agents that arrived: shows its n, never ranks
    verifiable: bool = True  # False for timings
    rate: bool = False  # per-agent 0/1: its interval is one of binomials


def evaluate(metric: Metric, episode: Episode, members: BoolArray) -> tuple[float, int]:
    """Mean over the members (A,) where it is defined, and how many those are.

    Raises ValueError where the mean is larger than `LARGEST`.
    """
    if metric.scope == "group":
        value = float(metric.function(episode, members))
        defined = int(value == value)
    else:
        values = metric.function(episode)[members]  # type: ignore[index]
        known = values[values == values]
        value, defined = (float(known.mean()) if len(known) else float("nan")), len(known)
    if abs(value) > LARGEST:
        raise ValueError(f"a metric must be from {-LARGEST:g} to {LARGEST:g}; got {value:g}")
    return value, defined
