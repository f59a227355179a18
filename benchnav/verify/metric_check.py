"""Compare a run's values with those measured on the re-simulated episodes."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from benchnav.episode.episode import Episode
from benchnav.metrics.measure import is_own, load_metric, measure
from benchnav.plugins import METRICS
from benchnav.runner.execute.plugin_metrics import plugin_rows
from benchnav.runner.plan.task import Measuring
from benchnav.verify.finding import Report

TOLERANCE = 1e-9  # of a value; relative for values above 1
Rows = Mapping[int, list[dict[str, Any]]]  # of `benchnav.store.parts.results.RESULTS`, by seed


def measured_again(
    episodes: Sequence[Episode], names: Sequence[str], measuring: Measuring | None
) -> list[list[dict[str, Any]]]:
    """Return for each episode the rows of the metrics ``names``.

    Metrics of plugins are measured in separate processes; in this one if ``measuring``
    is None.
    """
    if measuring is None:
        return [measure(episode, [load_metric(name) for name in names]) for episode in episodes]
    own = [load_metric(name) for name in names if is_own(name)]
    rows = [measure(episode, own) for episode in episodes]
    for name in (name for name in names if not is_own(name)):
        guests = plugin_rows(
            name, episodes, measuring.registrations, measuring.main, measuring.timeout
        )
        for episode_rows, more in zip(rows, guests, strict=True):
            episode_rows += more
    return rows


def check_values(
    stored: Sequence[Mapping[str, Any]],
    right: Sequence[Mapping[str, Any]],
    known: Mapping[str, bool],
    where: str,
    report: Report,
) -> None:
    """Report every row that differs from ``right``, the rows of the re-simulated episode.

    ``known`` maps the metrics installed here to whether they are verifiable; values of other
    metrics are counted and not checked. A timing's value must follow from the stored timings,
    which cannot be verified themselves.
    """
    expected = {(row["role"], row["metric"]): row for row in right}
    earlier: set[tuple[str, str]] = set()
    for row in stored:
        key = row["role"], row["metric"]
        if key in earlier:
            report.find("metric", where, f"{_named(key)} is repeated")
        earlier.add(key)
        if row["metric"] not in known:
            report.unknown.add(row["metric"])
            report.notes[f"value of the metric {row['metric']!r}, which is not installed here"] += 1
        elif key not in expected:
            report.find("metric", where, f"{_named(key)} must not be there")
        else:
            _check_row(row, expected[key], where, report)
            kind = "values" if known[row["metric"]] else "values of timings"
            report.counts[kind] += 1
    for key in sorted(expected.keys() - earlier):
        report.find("metric", where, f"{_named(key)} is missing")


def _check_row(
    row: Mapping[str, Any], right: Mapping[str, Any], where: str, report: Report
) -> None:
    for name, value in right.items():
        if name in ("traceback", "remarks") and row[name] is None:
            continue  # older parts do not have it
        if name == "traceback" and value is not None:
            continue  # a traceback depends on the versions of libraries
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


def expected_metrics(stored: set[str], version: str, known: Iterable[str]) -> tuple[str, ...]:
    """Return the metrics that must be measured: stored ones known here, and all shipped ones.

    ``version`` is that of the benchnav that produced the run: if it equals this one, no
    shipped metric may be missing.
    """
    ours = f"benchnav {version}"
    return tuple(
        name
        for name in sorted(known)
        if name in stored or METRICS.source(name).distribution == ours
    )
