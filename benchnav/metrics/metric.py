"""A metric: a pure function of an episode, with unit, direction, range and reference."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from benchnav.arrays import BoolArray, FloatArray
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
    """Mean over the members (A,) where it is defined, and how many those are."""
    if metric.scope == "group":
        value = float(metric.function(episode, members))
        return value, int(value == value)
    values = metric.function(episode)[members]  # type: ignore[index]
    defined = values[values == values]
    return (float(defined.mean()) if len(defined) else float("nan")), len(defined)
