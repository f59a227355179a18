"""Notes below a table: reasons of failures and remarks of navigators, with numbers of worlds."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from benchnav.leaderboard.record import ALL, Record
from benchnav.navigation.command_check import grouped, one_of_each_kind

if TYPE_CHECKING:
    import pyarrow as pa

KEYS = ("split", "track", "perception", "role", "navigator")
SHOWN = 3  # texts of one navigator
Texts = Mapping[tuple[str, ...], Counter[str]]
"""By `KEYS` and scenario, or `ALL`: text → the worlds that it is about."""


def failures(results: pa.Table) -> Texts:
    """Return the reasons of failures in results (`benchnav.store.parts.results.RESULTS`)."""
    import pyarrow.compute as pc

    failed = results.filter(pc.not_equal(results["failure"], ""))
    return _counted((row, [row["failure"]]) for row in _worlds(failed, "failure"))


def remarks(results: pa.Table) -> Texts:
    """Return the remarks of navigators; none for results without that column."""
    import pyarrow.compute as pc

    if "remarks" not in results.column_names:
        return {}
    remarked = results.filter(pc.greater(pc.list_value_length(results["remarks"]), 0))
    return _counted((row, row["remarks"]) for row in _worlds(remarked, "remarks"))


def with_texts(record: Record, failed: Texts, remarked: Texts) -> Record:
    """Return the record with the failures and remarks of its episodes."""
    key = *(getattr(record, name) for name in KEYS), record.scenario
    return replace(
        record,
        failure=_summary(failed.get(key, Counter()), record.episodes),
        remark=_summary(remarked.get(key, Counter()), record.episodes),
    )


def _worlds(rows: pa.Table, column: str) -> Iterator[dict[str, Any]]:
    """Yield one row for each episode and role, for any number of metrics."""
    names = [*KEYS, "scenario", "scenario_hash", "seed"]
    seen: set[tuple[Any, ...]] = set()
    for row in rows.select([*names, column]).to_pylist():
        world = tuple(row[name] for name in names)
        if world not in seen:
            seen.add(world)
            yield row


def _counted(found: Iterator[tuple[dict[str, Any], list[str]]]) -> Texts:
    texts: dict[tuple[str, ...], Counter[str]] = {}
    for row, remarked in found:
        texts_of_world = one_of_each_kind(remarked)
        for scenario in (row["scenario"], ALL):
            key = *(str(row[name]) for name in KEYS), str(scenario)
            texts.setdefault(key, Counter()).update(texts_of_world)
    return texts


def _summary(texts: Counter[str], episodes: int) -> str:
    """Return ``in 12 of 40 worlds: …; in 1 of 40 worlds: …``."""
    groups = grouped(texts)
    worlds = "world" if episodes == 1 else "worlds"
    parts = [f"in {n} of {episodes} {worlds}: {text}" for text, n in groups[:SHOWN]]
    more = len(groups) - SHOWN
    return "; ".join([*parts, *([f"and {more} more"] if more > 0 else [])])
