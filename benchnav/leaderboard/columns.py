"""What a table may show, by name."""

from collections.abc import Callable, Mapping, Sequence

from benchnav.errors import UsageError, did_you_mean
from benchnav.leaderboard.record import Record
from benchnav.leaderboard.rendering.cell import Cell, rank, rehearsal, training, verified

DEFAULT = ("success", "collided", "spl", "time_to_goal", "turning", "latency_p50")
FEW = 4  # metrics that are shown where none of the default ones is held

DESCRIPTIVE: Mapping[str, Callable[[Record], Cell]] = {
    "rank": rank,
    "mode": lambda r: Cell(r.mode),
    "training": training,
    "rehearsal": rehearsal,
    "verified": verified,
}
"""Columns that are no metric, and what they show of a navigator's record."""
MIDDLE_HALF = "middle_half"
"""A column that shows another record: the interquartile mean over scenarios."""
NAMES = (*DESCRIPTIVE, MIDDLE_HALF)


def choose(held: Sequence[str], metrics: Sequence[str] | None) -> tuple[str, ...]:
    """The metrics to show of those ``held``: the default few, ``["all"]``, or those named.

    Raises UsageError for a metric that is not held.
    """
    if metrics is None:
        return tuple(name for name in DEFAULT if name in held) or tuple(held[:FEW])
    if list(metrics) == ["all"]:
        return tuple(held)
    for name in metrics:
        if name not in held:
            raise UsageError(
                f"A metric to show must be one that the leaderboard holds. Got {name!r} instead."
                f"{did_you_mean(name, held)} 'all' shows all."
            )
    return tuple(dict.fromkeys(metrics))


def choose_columns(held: Sequence[str], columns: Sequence[str]) -> tuple[str, ...]:
    """The columns to show, each once: metrics of those ``held``, or descriptive ones.

    Raises UsageError for another name, and where no metric is among them.
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
