"""What must be known of a table's runs before their numbers are believed."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from benchnav.leaderboard.marks import labels_of
from benchnav.leaderboard.record import ALL, ALL_INTERQUARTILE, Record
from benchnav.runner.plan.installed_differences import Caveat, caveats_of
from benchnav.store.runs.run_folder import RunFolder

if TYPE_CHECKING:
    import pyarrow as pa

_SHOWN = 5  # names in a sentence
_KEYS = ["navigator", "scenario", "track", "split", "metric"]


def table_caveats(folders: Sequence[RunFolder], tables: Sequence[pa.Table]) -> Iterator[Caveat]:
    """Where runs are not what their names say, of the labels and scenarios that have rows."""
    for folder, results in zip(folders, tables, strict=True):
        labels, scenarios = labels_of(results), set(results["scenario"].unique().to_pylist())
        for caveat in caveats_of(folder.manifest):
            if caveat.scenario in {"", *scenarios} and caveat.navigator in {"", *labels}:
                yield caveat


def metric_caveats(tables: Sequence[pa.Table], metrics: Collection[str]) -> Iterator[Caveat]:
    """Metrics that are installed and were not measured everywhere, and those not installed."""
    lacking: dict[str, set[str]] = defaultdict(set)  # label → metrics
    strange: set[str] = set()
    for results in tables:
        held: dict[tuple[str, ...], set[str]] = defaultdict(set)
        for row in results.select(_KEYS).group_by(_KEYS).aggregate([]).to_pylist():
            held[tuple(row[key] for key in _KEYS[:-1])].add(row["metric"])
        for (label, *_), names in held.items():
            strange |= names - set(metrics)
            lacking[label] |= set(metrics) - names
    for label, names in sorted(lacking.items()):
        if names:
            yield Caveat(f"Not measured in all episodes of {label}: {_listed(names)}.", "", label)
    if strange:
        yield Caveat(f"Not installed here, so that nothing says what it is: {_listed(strange)}.")


def with_caveats(record: Record, caveats: Sequence[Caveat]) -> Record:
    """Return the record, with what must be known of its scenario, navigator and runs."""
    whole = record.scenario in (ALL, ALL_INTERQUARTILE)
    own = [
        caveat.text
        for caveat in caveats
        if (whole or caveat.scenario in ("", record.scenario))
        and caveat.navigator in ("", record.navigator)
    ]
    return replace(record, caveat=" ".join(own))


def _listed(names: Collection[str]) -> str:
    few = ", ".join(sorted(names)[:_SHOWN])
    return few if len(names) <= _SHOWN else f"{few} and {len(names) - _SHOWN} more"
