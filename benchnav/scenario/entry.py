"""Times at which the agents of a team enter the arena."""

from typing import Annotated, Any

from pydantic import Discriminator, Field, Tag

from benchnav.scenario.base import Spec
from benchnav.scenario.law import Time
from benchnav.scenario.sampling.sampler import (
    NonNegativeScalar,
    PositiveScalar,
    is_scalar,
    support,
)


class Stream(Spec):
    """The agents enter one after another."""

    every: PositiveScalar = Field(
        description="time [s] from one entry to the next; each is drawn from a distribution"
    )
    begin: Time = Field(0.0, description="time [s] of the first entry")


def _tag(value: Any) -> str | None:
    """Return the union tag, which differs from all keys, so that error paths are unambiguous."""
    if isinstance(value, list | tuple):
        return "several times"
    if isinstance(value, Stream) or (isinstance(value, dict) and {"every", "begin"} & set(value)):
        return "a stream"
    return "a time" if not isinstance(value, str) and is_scalar(value) else None


Entry = Annotated[
    Annotated[NonNegativeScalar, Tag("a time")]
    | Annotated[tuple[Time, ...], Field(min_length=1, max_length=5000), Tag("several times")]
    | Annotated[Stream, Tag("a stream")],
    Discriminator(
        _tag,
        custom_error_type="entry",
        custom_error_message="must be a time [s], a distribution such as {uniform: [0, 30]}, a list"
        " with a time for each agent, or {every: 2, begin: 0}",
    ),
]
"""One time [s] or distribution for all, a list of times, or a stream."""


def first_entry(entry: Entry) -> float:
    """Return the earliest time [s] at which an agent can enter."""
    if isinstance(entry, Stream):
        return entry.begin
    return min(entry) if isinstance(entry, tuple) else support(entry)[0]


def enter_together(entry: Entry) -> bool:
    """Whether all agents enter at one time."""
    if isinstance(entry, Stream | tuple):
        return False
    low, high = support(entry)
    return low == high
