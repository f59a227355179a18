"""Check that a label names one navigator: different configurations or code are never merged."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from benchnav.errors import UsageError
from benchnav.navigation.plugin.trainings import entry_of

if TYPE_CHECKING:
    import pyarrow as pa

_COLUMNS = {
    "navigator_hash": "configuration (parameters, version, weights or mode)",
    "source_hash": "source",
}
"""Columns that must have one value for a label → the name of the difference if they have two."""


def require_one_navigator_per_label(tables: Mapping[str, pa.Table]) -> None:
    """Raise UsageError if rows with one label come from two configurations or sources.

    ``tables`` maps names, such as run folders, to results (RESULTS). Rows without a
    hash, such as those of older runs, agree with all.
    """
    for column, difference in _COLUMNS.items():
        _require_one(tables, column, difference)
    labels = {
        label for table in tables.values() for label in table["navigator"].unique().to_pylist()
    }
    for label in sorted(labels):
        if entry_of(label) != label and entry_of(label) in labels:
            raise UsageError(
                f"The label {entry_of(label)!r} must stand for one navigator. It stands for one"
                f" training and for an entry with several, such as {label!r}. Leave one out, or"
                " give it a label of its own and run it again."
            )


def _require_one(tables: Mapping[str, pa.Table], column: str, difference: str) -> None:
    seen: dict[str, tuple[str, str]] = {}  # label → hash, and the table where it occurs first
    for name, table in tables.items():
        if column not in table.column_names:
            continue
        groups = table.select(["navigator", column]).group_by(["navigator", column]).aggregate([])
        for row in sorted(
            groups.to_pylist(), key=lambda row: (row["navigator"], row[column] or "")
        ):
            label, found = row["navigator"], row[column]
            if not found:
                continue
            known, where = seen.setdefault(label, (found, name))
            if known != found:
                raise UsageError(
                    f"The label {label!r} must stand for one navigator. It stands for two: their"
                    f" {difference} differs ({known[:12]} in {where} and {found[:12]} in {name})."
                    f" {_CURES[column]}, or give one of them a label of its own"
                    f" ({{type: …, label: {label}-2}} in the suite) and run that one again."
                )


_CURES = {
    "navigator_hash": "Leave one out",
    "source_hash": "Run the older one again (option 'again')",
}
