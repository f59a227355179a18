"""The condition of an episode in words: its knowledge track, and its perception unless exact."""

from collections.abc import Collection, Mapping
from typing import Any

from benchnav.errors import UsageError, did_you_mean
from benchnav.scenario.terms import PERCEPTIONS, TRACKS

EXACT = "exact"
"""The perception of runs that name none, such as those of older versions."""
NOISY = "noisy"
"""The perception with the noise of the scenario."""


def condition(track: str, perception: str) -> str:
    """Return ``known``, or ``known, noisy``."""
    return track if perception == EXACT else f"{track}, {perception}"


def described(track: str, perception: str) -> str:
    """Return ``track known``, or ``track known, noisy perception``."""
    return f"track {condition(track, perception)}" + ("" if perception == EXACT else " perception")


def episode_name(navigator: str, scenario: str, track: str, perception: str, seed: int) -> str:
    """Return ``orca/trap/u@1/known/3``, or ``orca/trap/u@1/known/noisy/3``."""
    return f"{navigator}/{scenario}/{condition(track, perception).replace(', ', '/')}/{seed}"


def perception_of(cell: Mapping[str, Any]) -> str:
    """Return the perception of a cell of a manifest."""
    return str(cell.get("perception", EXACT))


def perceptions_of(suite: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the perceptions of a resolved suite, as a manifest holds it."""
    return tuple(map(str, suite.get("perception", (EXACT,))))


def require_track(track: str) -> None:
    """Raise UsageError for a track that does not exist."""
    _require("track", track, TRACKS)


def require_perception(perception: str) -> None:
    """Raise UsageError for a perception that does not exist."""
    _require("perception", perception, PERCEPTIONS)


def _require(what: str, name: str, known: Collection[str]) -> None:
    if name not in known:
        raise UsageError(
            f"A {what} must be one of {', '.join(known)}. Got {name!r} instead."
            f"{did_you_mean(name, known)}"
        )
