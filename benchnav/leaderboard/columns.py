"""The columns that a table can show, by name."""

from collections.abc import Callable, Mapping, Sequence

from benchnav.errors import UsageError, did_you_mean
from benchnav.leaderboard.record import Record
from benchnav.leaderboard.rendering.cell import (
    Cell,
    rank,
    rehearsal,
    training,
    trainings,
    verified,
)

DEFAULT = ("success", "collided", "spl", "time_to_goal", "turning", "latency_p50")
PROFILES: Mapping[str, tuple[str, ...]] = {
    "people": (
        "success", "collisions_people", "collisions_at_fault", "personal_space_approach",
        "intrusion", "avoidance",
    ),
}  # fmt: skip
"""Names that stand for several metrics."""
FEW = 4  # metrics to show if the results contain none of the default ones

DESCRIPTIVE: Mapping[str, Callable[[Record], Cell]] = {
    "rank": rank,
    "mode": lambda r: Cell(r.mode),
    "training": training,
    "trainings": trainings,
    "rehearsal": rehearsal,
    "verified": verified,
}
"""Columns that are not metrics → the function from a navigator's record to its cell."""
MIDDLE_HALF = "middle_half"
"""A column that shows another record: the interquartile mean over scenarios."""
NAMES = (*DESCRIPTIVE, MIDDLE_HALF)


def choose(held: Sequence[str], metrics: Sequence[str] | None) -> tuple[str, ...]:
    """Return the metrics of ``held`` to show: the default ones, all (``["all"]``), or ``metrics``.

    A name of `PROFILES` stands for its metrics.

    Raises UsageError for a metric that is not in ``held``.
    """
    if metrics is None:
        return tuple(name for name in DEFAULT if name in held) or tuple(held[:FEW])
    if list(metrics) == ["all"]:
        return tuple(held)
    for name in metrics:
        if name not in held and not _held_of(name, held):
            raise UsageError(
                f"A metric to show must be one that the leaderboard holds. Got {name!r} instead."
                f"{did_you_mean(name, [*held, *PROFILES])} 'all' shows all."
            )
    shown = [part for name in metrics for part in _held_of(name, held) or (name,)]
    return tuple(dict.fromkeys(shown))


def _held_of(profile: str, held: Sequence[str]) -> tuple[str, ...]:
    """Return the metrics of a profile that the leaderboard holds; none of another name."""
    return tuple(name for name in PROFILES.get(profile, ()) if name in held)


def choose_columns(held: Sequence[str], columns: Sequence[str]) -> tuple[str, ...]:
    """Return the columns to show, each once: metrics of ``held``, or descriptive columns.

    Raises UsageError for an unknown name, and if none of the columns is a metric.
    """
    known = [*held, *NAMES]
    for name in columns:
        if name not in known:
            raise UsageError(
                "A column must be a metric that the leaderboard holds, or one of"
                f" {', '.join(NAMES)}. Got {name!r} instead.{did_you_mean(name, known)}"
            )
    if not any(name in held for name in columns):
        raise UsageError(
            f"At least one column must be a metric. Got {', '.join(columns) or 'none'}."
            f" Add one of {', '.join(choose(held, None))}."
        )
    return tuple(dict.fromkeys(columns))
