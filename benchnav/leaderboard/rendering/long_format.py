"""Write records as JSON and CSV: one row each; undefined values are null or empty."""

import csv
import io
import json
import math
from collections.abc import Sequence
from dataclasses import fields
from typing import Any

from benchnav.leaderboard.rendering import escape


def as_json(records: Sequence[Any]) -> str:
    """Return a list of objects, one per line, from records of one dataclass."""
    names = column_names(type(records[0]), records) if records else []
    lines = [json.dumps(_plain(record, names), allow_nan=False) for record in records]
    return "[\n" + ",\n".join(lines) + "\n]\n"


def as_csv(kind: type, records: Sequence[Any]) -> str:
    """Return a head line and a line for each record of the dataclass ``kind``."""
    out = io.StringIO()
    names = column_names(kind, records)
    writer = csv.DictWriter(out, names, lineterminator="\n")
    writer.writeheader()
    for record in records:
        row = _plain(record, names)
        writer.writerow(
            {k: escape.spreadsheet(v) if isinstance(v, str) else v for k, v in row.items()}
        )
    return out.getvalue()


def column_names(kind: type, records: Sequence[Any]) -> list[str]:
    """Return the fields of the dataclass ``kind``; an optional one only if some record has it."""
    return [
        f.name
        for f in fields(kind)
        if "optional" not in f.metadata or any(_has(r, f.name, f.default) for r in records)
    ]


def _has(record: Any, name: str, default: Any) -> bool:
    value = getattr(record, name)
    undefined = isinstance(value, float) and math.isnan(value)
    return not undefined and bool(value != default)


def _plain(record: Any, names: Sequence[str]) -> dict[str, Any]:
    row = {name: getattr(record, name) for name in names}
    return {k: None if isinstance(v, float) and math.isnan(v) else v for k, v in row.items()}
