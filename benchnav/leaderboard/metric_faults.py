"""Values that are missing because their metric failed: their number, and the reason."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from benchnav.leaderboard.record import ALL, Record
from benchnav.metrics.metric import NOT_APPLICABLE
from benchnav.text.plural import counted

if TYPE_CHECKING:
    import pyarrow as pa

KEYS = ("split", "track", "perception", "role", "navigator", "metric")
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
    failed = pc.invert(pc.starts_with(gaps["missing"].cast("string"), NOT_APPLICABLE))
    for row in [*gaps.filter(failed).to_pylist(), *_one_each(gaps.filter(pc.invert(failed)))]:
        world = row["scenario"], row["seed"]
        for scenario in (row["scenario"], ALL):
            key = *(row[name] for name in KEYS), scenario
            found.setdefault(key, {})[world] = row["missing"]
    return found


def _one_each(gaps: pa.Table) -> list[dict[str, Any]]:
    """Return one row for each scenario and reason, without the numbers: runs have many."""
    names = [*KEYS, "scenario", "missing"]
    plain = gaps.select([*names, "seed"]).cast(_plain(gaps.schema, [*names, "seed"]))
    each = plain.group_by(names).aggregate([("seed", "min")])
    return [row | {"seed": row["seed_min"]} for row in each.to_pylist()]


def _plain(schema: pa.Schema, names: Sequence[str]) -> pa.Schema:
    """Return the schema of some columns, with values in place of dictionaries."""
    import pyarrow as pa

    kinds = [schema.field(name).type for name in names]
    kinds = [k.value_type if pa.types.is_dictionary(k) else k for k in kinds]
    return pa.schema(list(zip(names, kinds, strict=True)))


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
