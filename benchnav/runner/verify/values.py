"""The values that a run holds beside those measured on the re-simulated episodes."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from benchnav.episode.episode import Episode
from benchnav.errors import PluginError
from benchnav.metrics.measure import is_own, load_metric, measure
from benchnav.metrics.metric import Metric
from benchnav.plugins import METRICS
from benchnav.runner.verify.finding import Report

TOLERANCE = 1e-9  # of a value; of its size where that is more than 1
Rows = Mapping[int, list[dict[str, Any]]]  # of `benchnav.store.results.RESULTS`, by seed


def check_values(
    stored: Sequence[Mapping[str, Any]],
    again: Episode,
    metrics: Sequence[Metric],
    where: str,
    report: Report,
) -> None:
    """Report every row that is not what ``metrics`` measure on the episode ``again``.

    Values of metrics that are not installed here are counted, and not checked. A timing's
    value must follow from the stored timings; that these are true, nobody can verify.
    """
    known = {metric.name: metric for metric in metrics}
    try:
        expected = {(r["role"], r["metric"]): r for r in measure(again, metrics)}
    except PluginError as error:
        report.find("metric", where, f"cannot be measured: {error}")
        return
    seen: set[tuple[str, str]] = set()
    for row in stored:
        key = row["role"], row["metric"]
        if key in seen:
            report.find("metric", where, f"{_named(key)} stands twice")
        seen.add(key)
        if row["metric"] not in known:
            report.unknown.add(row["metric"])
            report.notes[f"value of the metric {row['metric']!r}, which is not installed here"] += 1
        elif key not in expected:
            report.find("metric", where, f"{_named(key)} must not be there")
        else:
            _check_row(row, expected[key], where, report)
            kind = "values" if known[row["metric"]].verifiable else "values of timings"
            report.counts[kind] += 1
    for key in sorted(expected.keys() - seen):
        report.find("metric", where, f"{_named(key)} lacks")


def _check_row(
    row: Mapping[str, Any], right: Mapping[str, Any], where: str, report: Report
) -> None:
    for name, value in right.items():
        if name in ("traceback", "remarks") and row[name] is None:
            continue  # older parts lack them
        if name == "traceback" and value is not None:
            continue  # its lines are those of the libraries that are installed
        close = _close(row[name], value) if name in ("value", "rehearsal_seconds") else None
        if not (row[name] == value if close is None else close):
            text = f"{_named((right['role'], right['metric']))} has"
            report.find("metric", where, f"{text} {name} {row[name]!r}, not {value!r}")


def _close(stored: float | None, right: float) -> bool:
    if stored is None or math.isnan(stored) or math.isnan(right):
        return stored is not None and math.isnan(stored) and math.isnan(right)
    if math.isinf(stored) or math.isinf(right):
        return stored == right
    return abs(stored - right) <= TOLERANCE * max(1.0, abs(right))


def _named(key: tuple[str, str]) -> str:
    return f"{key[1]} of {key[0]}s"


def expected_metrics(stored: set[str], version: str) -> tuple[Metric, ...]:
    """What must have been measured: what is stored and installed here, and all that shipped.

    ``version`` is that of the benchnav that made the run: if it is this one, none of the
    metrics that ship with it may lack.
    """
    ours = f"benchnav {version}"
    return tuple(
        metric
        for metric in _usable()
        if metric.name in stored or METRICS.source(metric.name).distribution == ours
    )


def _usable() -> Iterator[Metric]:
    """All installed metrics but those of plugins that cannot be loaded."""
    for name in METRICS.names():
        try:
            yield load_metric(name)
        except PluginError:
            if is_own(name):
                raise
