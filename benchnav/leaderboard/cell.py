"""One cell of a table for people: a number, its interval, and what it is based on."""

import math
from dataclasses import dataclass

from benchnav.leaderboard.record import PRICE, Record
from benchnav.plural import counted

PREFIXES = {  # unit → what it is divided by, and then called
    "s": ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns")),
    "B": ((1e9, "GB"), (1e6, "MB"), (1e3, "kB"), (1.0, "B")),
}
ROUNDING = 1e-12  # what is smaller is left over from arithmetic


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
    bounds = (r.low, r.high) if interval and not math.isnan(r.low) else ()
    widest = max(map(abs, (r.value, *bounds)))
    size, name = prefixed(r.unit, widest)
    say = signed_number if r.track == PRICE else number
    text, *ends = (say(x / size, widest / size) for x in (r.value, *bounds))
    if ends:
        text = f"{text} [{', '.join(ends)}]"
    unit = f" {name}" if name else ""
    count = f" ({r.defined})" if r.defined < r.episodes else ""
    return Cell(f"{text}{unit}{count}", decided and r.rank_low == 1)


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
    seconds = number(r.rehearsal_seconds / size, r.rehearsal_seconds / size)
    return Cell(f"{counted(round(r.rehearsal_decisions), 'decision')}, {seconds} {unit}")


def verified(r: Record) -> Cell:
    """Whether it was re-simulated here; empty for what was not run."""
    return Cell(("yes" if r.verified else "no") if r.episodes else "")


def heading(r: Record) -> Cell:
    """A metric and its direction."""
    return Cell(r.metric + {"higher": " ↑", "lower": " ↓", None: ""}[r.better])


def prefixed(unit: str, scale: float) -> tuple[float, str]:
    """What to divide by so that ``scale`` has digits before the point, and the unit then."""
    steps = PREFIXES.get(unit, ((1.0, unit),))
    if scale == 0.0:
        return 1.0, unit
    return next((step for step in steps if scale >= step[0]), steps[-1])


def number(value: float, scale: float) -> str:
    """About three figures, with as many decimals as ``scale`` takes."""
    if max(abs(scale), abs(value)) < ROUNDING or value == 0.0:
        return "0"
    size = math.floor(math.log10(abs(scale)))
    if size < -4 or size > 5:
        return f"{value:.1e}"
    return f"{value:.{max(0, 2 - max(size, 0)) if size >= -1 else 1 - size}f}"


def signed_number(value: float, scale: float) -> str:
    """The same of a difference: ``+1.25``, ``−0.5``, ``0``."""
    text = number(value, scale)
    return f"+{text}" if value > 0 and float(text) != 0.0 else text.replace("-", "−", 1)
