"""Values that are missing because their metric failed: their number, and the reason."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from benchnav.leaderboard.record import ALL, Record
from benchnav.text.plural import counted

if TYPE_CHECKING:
    import pyarrow as pa

KEYS = ("split", "track", "perception", "role", "navigator", "metric")
NOT_APPLICABLE = "n/a: "
"""A reason that begins so is no failure: the episodes do not hold what the metric needs."""
Faults = Mapping[tuple[str, ...], Mapping[tuple[str, int], str]]
"""By `KEYS` and scenario, or `ALL`: (scenario, seed) → the reason why the metric failed."""


def faults(results: pa.Table) -> Faults:
    """Return the faults in results of the schema `benchnav.store.parts.results.RESULTS`."""
    import pyarrow.compute as pc

    found: dict[tuple[str, ...], dict[tuple[str, int], str]] = {}
    if "missing" not in results.column_names:
        return found
    for row in results.filter(pc.not_equal(results["missing"], "")).to_pylist():
        world = row["scenario"], row["seed"]
        for scenario in (row["scenario"], ALL):
            key = *(row[name] for name in KEYS), scenario
            found.setdefault(key, {})[world] = row["missing"]
    return found


def with_fault(record: Record, found: Faults) -> Record:
    """Return the record with the reason for its missing values."""
    key = *(getattr(record, name) for name in KEYS), record.scenario
    if key not in found:
        return record
    reasons = Counter(found[key].values())
    if all(reason.startswith(NOT_APPLICABLE) for reason in reasons):
        return replace(record, fault=min(reasons))
    (why, _), *others = reasons.most_common()
    count = sum(reasons.values())
    more = f" (and {counted(len(others), 'more reason')})" if others else ""
    return replace(record, fault=f"failed in {counted(count, 'episode')}: {why}{more}")
