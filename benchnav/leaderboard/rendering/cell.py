"""One cell of a table: a number, its interval, and the number of episodes behind it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from benchnav.leaderboard.record import Record
from benchnav.leaderboard.rendering.digits import aligned, figure, figures, number, prefixed, signed
from benchnav.metrics.metric import NOT_APPLICABLE
from benchnav.text.plural import counted


@dataclass(frozen=True)
class Cell:
    """A piece of text; bold for the best, ties included."""

    text: str
    bold: bool = False


def cell(r: Record | None, *, interval: bool, decided: bool) -> Cell:
    """Return value, unit, interval if requested, and the number of defining episodes if not all.

    ``decided``: at least one entry is significantly worse than the best; only then is
    a bold cell informative.
    """
    if r is None or not r.episodes:
        return Cell("")
    if math.isnan(r.value) and r.fault.startswith(NOT_APPLICABLE):
        return Cell(f"n/a ({r.fault.removeprefix(NOT_APPLICABLE)})")
    if math.isnan(r.value):
        return Cell("–")
    text, name = _figures(r, interval)
    return _with_unit(r, text, name, decided)


def column(records: Sequence[Record | None], *, decided: bool) -> list[Cell]:
    """Return the cells of one metric with intervals: one unit and equal decimals, if possible."""
    alone = [cell(r, interval=True, decided=decided) for r in records]
    shown = [r for r in records if r is not None and r.episodes and not math.isnan(r.value)]
    if not shown:
        return alone
    unit = shown[0].unit
    size, name = prefixed(unit, max(abs(r.value) for r in shown))
    texts = aligned(
        [(r.value / size, r.low / size, r.high / size) for r in shown], None if unit else 1.0
    )
    if texts is None:
        return alone
    found = {
        id(r): _with_unit(r, f"{value} [{', '.join(ends)}]" if ends else value, name, decided)
        for r, (value, *ends) in zip(shown, texts, strict=True)
    }
    return [found.get(id(r), each) for r, each in zip(records, alone, strict=True)]


def _with_unit(r: Record, text: str, name: str, decided: bool) -> Cell:
    """Return a number with its unit, and the number of defining episodes if not all define it."""
    unit = f" {name}" if name else ""
    count = f" ({r.defined})" if r.defined < r.episodes else ""
    return Cell(f"{text}{unit}{count}", decided and r.rank_low == 1)


def _figures(r: Record, interval: bool) -> tuple[str, str]:
    """Return the number, with its interval if requested, and its unit."""
    whole = None if r.unit else 1.0  # of a share
    if math.isnan(r.low):
        size, name = prefixed(r.unit, abs(r.value))
        texts = [number(r.value / size, whole)]
    else:
        size, name = prefixed(r.unit, max(map(abs, (r.value, r.low, r.high))))
        numbers = r.value / size, r.low / size, r.high / size
        texts = list(figures(*numbers, whole)) if interval else [figure(*numbers, whole)]
    value, *ends = map(signed, texts) if r.price else texts
    return (f"{value} [{', '.join(ends)}]" if ends else value), name


def entrant(r: Record) -> Cell:
    """Return a navigator's name, and its number of failures."""
    return Cell(f"{r.navigator}, {r.failures} failed" if r.failures else r.navigator)


def rank(r: Record | None) -> Cell:
    """Return the rank: ``1``, ``1–3`` for a tie, ``–`` without a rank."""
    if r is None or r.rank_low is None or r.rank_high is None:
        return Cell("–")
    tie = r.rank_low != r.rank_high
    return Cell(f"{r.rank_low}–{r.rank_high}" if tie else f"{r.rank_low}")


def training(r: Record) -> Cell:
    """Return the amount and time of training, ``6.5 M, 38 min``; empty without training."""
    if math.isnan(r.training_decisions):
        return Cell("")
    seconds = r.training_seconds
    time = f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"
    millions = r.training_decisions / 1e6
    return Cell(f"{millions:.1f} M, {time}" if millions >= 0.1 else f"{millions:.2g} M, {time}")


def trainings(r: Record) -> Cell:
    """Return the range of the means of trainings, ``0.884–0.893 (3)``; empty for one training."""
    if r.trainings < 2 or math.isnan(r.training_least):
        return Cell(f"({r.trainings})" if r.trainings > 1 else "")
    size, name = prefixed(r.unit, max(abs(r.training_least), abs(r.training_most)))
    least, _, most = figures(
        r.training_least / size, r.training_least / size, r.training_most / size,
        None if r.unit else 1.0,
    )  # fmt: skip
    unit = f" {name}" if name else ""
    ends = least if least == most else f"{least}–{most}"
    return Cell(f"{ends}{unit} ({r.trainings})")


def rehearsal(r: Record) -> Cell:
    """Return the cost of rehearsals per world, ``812 decisions, 3.2 ms``; empty without."""
    if math.isnan(r.rehearsal_seconds):
        return Cell("")
    size, unit = prefixed("s", r.rehearsal_seconds)
    seconds = number(r.rehearsal_seconds / size)
    return Cell(f"{counted(round(r.rehearsal_decisions), 'decision')}, {seconds} {unit}")


def verified(r: Record) -> Cell:
    """Return whether the entry was verified here; empty for entries that were not run."""
    return Cell(("yes" if r.verified else "no") if r.episodes else "")


def heading(r: Record) -> Cell:
    """Return a metric and its direction."""
    return Cell(r.metric + {"higher": " ↑", "lower": " ↓", None: ""}[r.better])
