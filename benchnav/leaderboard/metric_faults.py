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
"""By `KEYS` and scenario, or `ALL`: (scenario, seed) → the reason why the metric failed.

Of the worlds of a scenario that do not hold what a metric needs, one stands for all.
"""


def faults(results: pa.Table) -> Faults:
    """Return the faults in results of the schema `benchnav.store.parts.results.RESULTS`."""
    import pyarrow.compute as pc

    found: dict[tuple[str, ...], dict[tuple[str, int], str]] = {}
    if "missing" not in results.column_names:
        return found
    gaps = results.filter(pc.not_equal(results["missing"], ""))
    failed = pc.invert(pc.starts_with(gaps["missing"], NOT_APPLICABLE))
    without = gaps.filter(pc.invert(failed)).select([*KEYS, "scenario", "missing", "seed"])
    each = without.group_by([*KEYS, "scenario", "missing"]).aggregate([("seed", "min")])
    each = each.rename_columns([name.removesuffix("_min") for name in each.column_names])
    for row in [*gaps.filter(failed).to_pylist(), *each.to_pylist()]:
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
    reasons = Counter({why: n for why, n in reasons.items() if not why.startswith(NOT_APPLICABLE)})
    (why, _), *others = reasons.most_common()
    count = sum(reasons.values())
    more = f" (and {counted(len(others), 'more reason')})" if others else ""
    return replace(record, fault=f"failed in {counted(count, 'episode')}: {why}{more}")
