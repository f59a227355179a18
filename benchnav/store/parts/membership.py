"""The cell and seeds that every row of a part must have.

Tables are built from rows, not from file names. Therefore every reader refuses a row of another
navigator, scenario or seed.
"""

from collections.abc import Container, Mapping
from dataclasses import dataclass, field
from typing import Any

import pyarrow as pa

from benchnav.scenario.condition import EXACT, perception_of
from benchnav.store.runs.manifest import Manifest
from benchnav.store.runs.navigator_hash import hash_of_entry

_HASHED = 3  # first schema in which every row holds the hash of its navigator
_NUMBERS = ("seed", "rehearsal", "rehearsals")
_SHOWN = 80  # characters of a value in a message
_NO_ENTRY: Mapping[str, Any] = {"config": {}, "source": ""}  # of undisturbed episodes


@dataclass(frozen=True)
class Membership:
    """The cell of a part, and the seal that the part must still have."""

    cell: Mapping[str, Container[Any]]  # column → allowed values
    granted: int  # rehearsals of each world that the navigator requests
    seals: Mapping[str, str] = field(default_factory=dict)  # name → sha256; empty: any seal

    def require_rows(self, table: pa.Table, seeds: range, *, scored: bool) -> None:
        """Raise ValueError for the first foreign row of a table of episodes or results.

        ``scored``: the rows are of scored episodes; otherwise of rehearsals.
        """
        allowed = {**self.cell, "seed": seeds}
        if "metric" in table.column_names:
            allowed["rehearsal"] = {self.granted}
        elif scored:
            allowed |= {"rehearsal": {0}, "rehearsals": {self.granted}}
        else:
            allowed |= {"rehearsal": range(1, self.granted + 1)}
        for name, values in allowed.items():
            _require(table, name, values)
        if scored and "metric" not in table.column_names:
            _require_each_once(table, seeds)


def membership(manifest: Manifest, cell: Mapping[str, Any], seals: Mapping[str, str]) -> Membership:
    """Return the values that the rows of a cell must have.

    ``seals`` maps the names of the seals of its parts to their sha256; empty: any seal is
    accepted. Raises ValueError if the manifest is incomplete.
    """
    label, identity = str(cell.get("navigator")), str(cell.get("scenario"))
    suite = manifest.suite
    if manifest.is_undisturbed(cell):
        entry = _NO_ENTRY
    else:
        entry = _one(suite.get("navigators", ()), "label", label)
    scenario = _one(suite.get("scenarios", ()), "scenario", identity)
    own = hash_of_entry(entry)
    values: dict[str, Container[Any]] = {
        "navigator": {label},
        "scenario": {identity},
        "scenario_hash": {scenario.get("hash")},
        "track": {cell.get("track")},
        "perception": {EXACT, ""} if perception_of(cell) == EXACT else {perception_of(cell)},
        "split": {suite.get("split")},
        "navigator_hash": {own} if manifest.schema >= _HASHED else {own, ""},
        "source_hash": {manifest.source_of(label)},
    }
    return Membership(values, int(entry.get("rehearsal", 0)), seals)


def _one(entries: Any, key: str, name: str) -> Mapping[str, Any]:
    found = [entry for entry in entries if entry.get(key) == name]
    if len(found) != 1:
        raise ValueError(
            f"the suite must name the {key} {name[:_SHOWN]!r} once, not {len(found)} ×"
        )
    entry: Mapping[str, Any] = found[0]
    return entry


def _require(table: pa.Table, name: str, allowed: Container[Any]) -> None:
    missing = 0 if name in _NUMBERS else ""  # replaces null, and columns of later versions
    if name not in table.column_names:
        if missing not in allowed:
            raise ValueError(f"must have a column {name}")
        return
    column = table.column(name)
    for value in column.unique().to_pylist():
        if (missing if value is None else value) not in allowed:
            row = column.to_pylist().index(value)
            raise ValueError(
                f"must have {name} {_shown(allowed)} in row {row}, as its part is of that cell;"
                f" it has {str(value)[:_SHOWN]!r}"
            )


def _require_each_once(table: pa.Table, seeds: range) -> None:
    held = table.column("seed").to_pylist()
    for row, seed in enumerate(sorted(held)):
        if seed != seeds.start + row:
            raise ValueError(
                f"must hold each of its seeds once; seed {seed} is in row"
                f" {held.index(seed)} and another is missing"
            )
    if len(held) != len(seeds):
        raise ValueError(f"must hold {len(seeds)} episodes; it holds {len(held)}")


def _shown(allowed: Container[Any]) -> str:
    if isinstance(allowed, range):
        return f"from {allowed.start} to {allowed.stop - 1}"
    return " or ".join(repr(str(value)[:_SHOWN]) for value in sorted(map(str, allowed)))  # type: ignore[call-overload]
