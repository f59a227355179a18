"""One cell of a table for people: a number, its interval, and what it is based on."""

import math
from dataclasses import dataclass

from benchnav.leaderboard.record import PRICE, Record
from benchnav.leaderboard.rendering.digits import figure, figures, number, prefixed, signed
from benchnav.text.plural import counted


@dataclass(frozen=True)
class Cell:
    """A piece of text; bold for the best, ties included."""

    text: str
    bold: bool = False


def cell(r: Record | None, *, interval: bool, decided: bool) -> Cell:
    """Value, unit, interval if wanted, and how many episodes define it if not all do.

    ``decided`` says that somebody is significantly worse than the best: only then does
    a bold cell tell anything.
    """
    if r is None or not r.episodes:
        return Cell("")
    if math.isnan(r.value):
        return Cell("–")
    text, name = _figures(r, interval)
    unit = f" {name}" if name else ""
    count = f" ({r.defined})" if r.defined < r.episodes else ""
    return Cell(f"{text}{unit}{count}", decided and r.rank_low == 1)


def _figures(r: Record, interval: bool) -> tuple[str, str]:
    """The number, with its interval if wanted, and the unit that it is in."""
    whole = None if r.unit else 1.0  # of a share
    if math.isnan(r.low):
        size, name = prefixed(r.unit, abs(r.value))
        texts = [number(r.value / size, whole)]
    else:
        size, name = prefixed(r.unit, max(map(abs, (r.value, r.low, r.high))))
        numbers = r.value / size, r.low / size, r.high / size
        texts = list(figures(*numbers, whole)) if interval else [figure(*numbers, whole)]
    value, *ends = map(signed, texts) if r.track == PRICE else texts
    return (f"{value} [{', '.join(ends)}]" if ends else value), name


def entrant(r: Record) -> Cell:
    """A navigator's name, and how often it failed."""
    return Cell(f"{r.navigator}, {r.failures} failed" if r.failures else r.navigator)


def rank(r: Record | None) -> Cell:
    """``1``, ``1–3`` for a tie, ``–`` where it does not rank."""
    if r is None or r.rank_low is None or r.rank_high is None:
        return Cell("–")
    tie = r.rank_low != r.rank_high
    return Cell(f"{r.rank_low}–{r.rank_high}" if tie else f"{r.rank_low}")


def training(r: Record) -> Cell:
    """What it learned from and how long, ``6.5 M, 38 min``; empty if it did not learn."""
    if math.isnan(r.training_decisions):
        return Cell("")
    seconds = r.training_seconds
    time = f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"
    millions = r.training_decisions / 1e6
    return Cell(f"{millions:.1f} M, {time}" if millions >= 0.1 else f"{millions:.2g} M, {time}")


def rehearsal(r: Record) -> Cell:
    """What rehearsing cost in a world, ``812 decisions, 3.2 ms``; empty without."""
    if math.isnan(r.rehearsal_seconds):
        return Cell("")
    size, unit = prefixed("s", r.rehearsal_seconds)
    seconds = number(r.rehearsal_seconds / size)
    return Cell(f"{counted(round(r.rehearsal_decisions), 'decision')}, {seconds} {unit}")


def verified(r: Record) -> Cell:
    """Whether it was re-simulated here; empty for what was not run."""
    return Cell(("yes" if r.verified else "no") if r.episodes else "")


def heading(r: Record) -> Cell:
    """A metric and its direction."""
    return Cell(r.metric + {"higher": " ↑", "lower": " ↓", None: ""}[r.better])
