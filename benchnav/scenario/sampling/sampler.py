"""Samplers: a scenario accepts a distribution wherever it accepts a number."""

from typing import Annotated, Any

import numpy as np
from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from benchnav.config.validation import FieldError
from benchnav.scenario.base import Spec

Number = Annotated[float, Field(ge=-1e6, le=1e6)]
_NORMAL_TRIES = 1000


def _rising(low: float, high: float, key: str) -> None:
    if low > high:
        raise FieldError((key,), f"must be [low, high] with low ≤ high; got [{low:g}, {high:g}]")


class Uniform(Spec):
    """A uniform distribution over [a, b)."""

    uniform: tuple[Number, Number] = Field(description="limits [a, b] with a ≤ b")

    @model_validator(mode="after")
    def _check(self) -> "Uniform":
        _rising(*self.uniform, "uniform")
        return self


class Normal(Spec):
    """A normal distribution; values outside [low, high] are drawn again."""

    normal: tuple[Number, Annotated[Number, Field(ge=0)], Number, Number] = Field(
        description="[mean, standard deviation, low, high] with low ≤ mean ≤ high"
    )

    @model_validator(mode="after")
    def _check(self) -> "Normal":
        mean, _, low, high = self.normal
        if not low <= mean <= high:
            raise FieldError(
                ("normal",),
                "must be [mean, standard deviation, low, high] with low ≤ mean ≤ high;"
                f" got mean {mean:g}, low {low:g}, high {high:g}",
            )
        return self


class Choice(Spec):
    """One of several numbers, all equally likely."""

    choice: tuple[Number, ...] = Field(min_length=1, max_length=1000, description="the numbers")


class Integers(Spec):
    """A whole number from a to b, both included, all equally likely."""

    integers: tuple[
        Annotated[int, Field(ge=-(10**6), le=10**6)], Annotated[int, Field(ge=-(10**6), le=10**6)]
    ] = Field(description="limits [a, b] with a ≤ b")

    @model_validator(mode="after")
    def _check(self) -> "Integers":
        _rising(*self.integers, "integers")
        return self


_KINDS = ("uniform", "normal", "choice", "integers")


def _union_tag(value: Any) -> str | None:
    """Return the union tag, which differs from all keys, so that error paths are unambiguous."""
    if isinstance(value, Spec):
        return f"a {type(value).__name__.lower()}"
    if isinstance(value, dict):
        return next((f"a {kind}" for kind in _KINDS if kind in value), None)
    return None if isinstance(value, list | tuple) else "a number"


Scalar = Annotated[
    Annotated[Number, Tag("a number")]
    | Annotated[Uniform, Tag("a uniform")]
    | Annotated[Normal, Tag("a normal")]
    | Annotated[Choice, Tag("a choice")]
    | Annotated[Integers, Tag("a integers")],
    Discriminator(
        _union_tag,
        custom_error_type="sampler",
        custom_error_message="must be a number or one of {uniform: [a, b]},"
        " {normal: [mean, sd, low, high]}, {choice: [a, b, c]}, {integers: [a, b]}",
    ),
]


def is_scalar(value: Any) -> bool:
    """Whether a value of a file has the form of a `Scalar`; its numbers may be wrong."""
    return _union_tag(value) is not None


def support(scalar: "Scalar") -> tuple[float, float]:
    """Return the smallest and largest number that can be drawn."""
    match scalar:
        case Uniform(uniform=(low, high)) | Integers(integers=(low, high)):
            return float(low), float(high)
        case Normal(normal=(_, _, low, high)):
            return low, high
        case Choice(choice=numbers):
            return min(numbers), max(numbers)
        case _:
            return float(scalar), float(scalar)


def sample(scalar: "Scalar", rng: np.random.Generator) -> float:
    """Draw a number; a plain number draws nothing from ``rng``."""
    match scalar:
        case Uniform(uniform=(low, high)):
            return low + (high - low) * rng.random()
        case Integers(integers=(first, last)):
            return float(rng.integers(first, last, endpoint=True))
        case Choice(choice=numbers):
            return numbers[int(rng.integers(len(numbers)))]
        case Normal(normal=(mean, sd, low, high)):
            for _ in range(_NORMAL_TRIES):
                value = mean + sd * float(rng.standard_normal())
                if low <= value <= high:
                    return value
            return mean
        case _:
            return float(scalar)


def fixed(scalar: "Scalar") -> bool:
    """Whether every draw is the same number."""
    low, high = support(scalar)
    return low == high


def _range_text(scalar: "Scalar") -> str:
    low, high = support(scalar)
    return f"{low:g}" if low == high else f"a range from {low:g} to {high:g}"


def _positive(scalar: "Scalar") -> "Scalar":
    if support(scalar)[0] <= 0:
        raise ValueError(f"must be > 0; got {_range_text(scalar)}")
    return scalar


def _not_negative(scalar: "Scalar") -> "Scalar":
    if support(scalar)[0] < 0:
        raise ValueError(f"must be ≥ 0; got {_range_text(scalar)}")
    return scalar


def _whole(scalar: "Scalar") -> "Scalar":
    numbers = scalar.choice if isinstance(scalar, Choice) else support(scalar)
    if isinstance(scalar, Uniform | Normal) or any(n != int(n) or n < 0 for n in numbers):
        raise ValueError("must be a whole number ≥ 0, {integers: [a, b]} or {choice: [a, b, c]}")
    return scalar


PositiveScalar = Annotated[Scalar, AfterValidator(_positive)]
NonNegativeScalar = Annotated[Scalar, AfterValidator(_not_negative)]
Count = Annotated[Scalar, AfterValidator(_whole)]
