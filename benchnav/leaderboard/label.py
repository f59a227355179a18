"""One label stands for one navigator: what was configured differently is never merged."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from benchnav.errors import UsageError

if TYPE_CHECKING:
    import pyarrow as pa

COLUMN = "navigator_hash"


def require_one_navigator_per_label(tables: Mapping[str, pa.Table]) -> None:
    """Raise UsageError where rows with one label come from differently configured navigators.

    ``tables`` maps names, such as run folders, to results (RESULTS). Rows that hold no
    hash, as those of older runs, agree with all.
    """
    seen: dict[str, tuple[str, str]] = {}  # label -> hash, where it was met first
    for name, table in tables.items():
        if COLUMN not in table.column_names:
            continue
        groups = table.select(["navigator", COLUMN]).group_by(["navigator", COLUMN]).aggregate([])
        for row in sorted(
            groups.to_pylist(), key=lambda row: (row["navigator"], row[COLUMN] or "")
        ):
            label, found = row["navigator"], row[COLUMN]
            if not found:
                continue
            known, where = seen.setdefault(label, (found, name))
            if known != found:
                raise UsageError(
                    f"The label {label!r} must stand for one navigator. It stands for two:"
                    f" {known[:12]} in {where} and {found[:12]} in {name} are configured"
                    " differently, run in another mode, or are different code. Tell them apart by"
                    f" a label of its own for one of them ({{type: …, label: {label}-2}} in the"
                    " suite), and run"
                    " that one again."
                )
