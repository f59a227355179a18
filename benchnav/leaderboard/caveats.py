"""Caveats: facts about the runs of a table that a reader must know."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from benchnav.leaderboard.marks import labels_of
from benchnav.leaderboard.record import ALL, ALL_INTERQUARTILE, Record
from benchnav.navigation.plugin.trainings import entry_of
from benchnav.runner.plan.installed_differences import Caveat, caveats_of
from benchnav.store.runs.run_folder import RunFolder

if TYPE_CHECKING:
    import pyarrow as pa

_SHOWN = 5  # names in a sentence
_KEYS = ["navigator", "scenario", "track", "perception", "split", "metric"]


def table_caveats(folders: Sequence[RunFolder], tables: Sequence[pa.Table]) -> Iterator[Caveat]:
    """Yield the caveats of the runs that are about labels and scenarios with rows."""
    for folder, results in zip(folders, tables, strict=True):
        labels, scenarios = labels_of(results), set(results["scenario"].unique().to_pylist())
        for caveat in caveats_of(folder.manifest):
            if caveat.scenario in {"", *scenarios} and caveat.navigator in {"", *labels}:
                yield caveat


def metric_caveats(tables: Sequence[pa.Table], metrics: Collection[str]) -> Iterator[Caveat]:
    """Yield caveats about metrics not measured in all episodes, and about metrics not installed."""
    unmeasured: dict[str, set[str]] = defaultdict(set)  # label → metrics
    unknown: set[str] = set()
    for results in tables:
        held: dict[tuple[str, ...], set[str]] = defaultdict(set)
        for row in results.select(_KEYS).group_by(_KEYS).aggregate([]).to_pylist():
            held[tuple(row[key] for key in _KEYS[:-1])].add(row["metric"])
        for (label, *_), names in held.items():
            unknown |= names - set(metrics)
            unmeasured[label] |= set(metrics) - names
    for label, names in sorted(unmeasured.items()):
        if names:
            yield Caveat(f"Not measured in all episodes of {label}: {_listed(names)}.", "", label)
    if unknown:
        yield Caveat(f"Not installed here, so its definition is unknown: {_listed(unknown)}.")


def with_caveats(record: Record, caveats: Sequence[Caveat]) -> Record:
    """Return the record with the caveats about its scenario, navigator and runs."""
    whole = record.scenario in (ALL, ALL_INTERQUARTILE)
    own = [
        caveat.text
        for caveat in caveats
        if (whole or caveat.scenario in ("", record.scenario))
        and entry_of(caveat.navigator) in ("", record.navigator)
    ]
    return replace(record, caveat=" ".join(own))


def _listed(names: Collection[str]) -> str:
    few = ", ".join(sorted(names)[:_SHOWN])
    return few if len(names) <= _SHOWN else f"{few} and {len(names) - _SHOWN} more"
