"""Two navigators against each other, in words: paired differences, intervals, p-values."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from benchnav.errors import UsageError, did_you_mean
from benchnav.leaderboard import escape
from benchnav.leaderboard.cell import number, prefixed
from benchnav.leaderboard.interval import ALPHA
from benchnav.leaderboard.paired import Comparison, comparisons
from benchnav.leaderboard.tidy import as_csv, as_json
from benchnav.metrics.metric import Metric

if TYPE_CHECKING:
    import pyarrow as pa

FORMATS = ("markdown", "csv", "json")
SMALLEST = 1e-4  # p below which only that is said


def duel(
    results: pa.Table, metrics: Mapping[str, Metric], metric: str, first: str, second: str
) -> tuple[Comparison, ...]:
    """``first`` − ``second`` in every scenario, track and role that both were run in.

    p-values are adjusted over all pairs of navigators there. Raises UsageError where one of
    the two is not in ``results``, or they met nowhere.
    """
    known = sorted(results["navigator"].unique().to_pylist())
    for name in (first, second):
        if name not in known:
            raise UsageError(
                f"A navigator to compare must be one that was run. Got {name!r} instead."
                f"{did_you_mean(name, known)}"
            )
    if first == second:
        raise UsageError(f"Two different navigators can be compared. Got {first!r} twice.")
    pair = {first, second}
    every = comparisons(results, metrics, metric)
    found = [_turned(c, first) for c in every if {c.first, c.second} == pair]
    if not found:
        raise UsageError(
            f"Navigators to compare must have been measured by {metric!r} in the same scenario"
            f" and track. {first!r} and {second!r} never were."
        )
    return tuple(found)


def _turned(c: Comparison, first: str) -> Comparison:
    if c.first == first:
        return c
    return replace(
        c, first=c.second, second=c.first, difference=-c.difference, low=-c.high, high=-c.low,
        first_rehearsal=c.second_rehearsal, second_rehearsal=c.first_rehearsal,
    )  # fmt: skip


def render_duel(
    found: Sequence[Comparison], metrics: Mapping[str, Metric], format: str = "markdown"
) -> str:
    """Comparisons as text that ends with a line break: sentences, or tidy CSV or JSON.

    Raises UsageError for another format.
    """
    if format not in FORMATS:
        raise UsageError(f"A comparison comes as {', '.join(FORMATS)}. Got {format!r} instead.")
    if format == "json":
        return as_json(found)
    if format == "csv":
        return as_csv(Comparison, found)
    lines = [f"- {escape.markdown(sentence(c, metrics[c.metric]))}" for c in found]
    legend = (
        "Mean of the differences in the worlds of both, its 95 % interval, p by sign flips, and p"
        " after Holm over all pairs of navigators in that scenario, track and role."
    )
    return "\n".join([*lines, "", legend, ""])


def sentence(c: Comparison, metric: Metric) -> str:
    """What one comparison says."""
    where = f"{c.scenario}, track {c.track}, {c.role}s, {c.metric}"
    first, second = _named(c.first, c.first_rehearsal), _named(c.second, c.second_rehearsal)
    if not c.worlds:
        return f"{where}: no world in which both {first} and {second} have a value."
    bounds = () if math.isnan(c.low) else (c.low, c.high)
    widest = max(map(abs, (c.difference, *bounds)))
    size, unit = prefixed(metric.unit, widest)
    value, *ends = (_signed(x / size, widest / size) for x in (c.difference, *bounds))
    interval = f" [{', '.join(ends)}]" if ends else ""
    worlds = f"{c.worlds} world{'s' if c.worlds > 1 else ''}"
    return (
        f"{where}: {first} − {second} = {value}{interval}{' ' if unit else ''}{unit}"
        f" over {worlds}; p {_chance(c.p)}, after Holm {_chance(c.adjusted)}:"
        f" {_verdict(c, metric)}."
    )


def _named(navigator: str, rehearsal: int) -> str:
    return f"{navigator} (rehearsal: {rehearsal})" if rehearsal else navigator


def _verdict(c: Comparison, metric: Metric) -> str:
    if not c.adjusted < ALPHA:
        return "no significant difference"
    if metric.better is None or metric.conditional:
        return f"{c.first} is significantly {'higher' if c.difference > 0 else 'lower'}"
    ahead = (c.difference > 0) == (metric.better == "higher")
    return f"{c.first} is significantly {'better' if ahead else 'worse'}"


def _signed(value: float, scale: float) -> str:
    text = number(value, scale)
    return f"+{text}" if value > 0 and text != "0" else text.replace("-", "−", 1)


def _chance(p: float) -> str:
    return f"below {SMALLEST:.4f}" if p < SMALLEST else f"= {p:.2g}"
