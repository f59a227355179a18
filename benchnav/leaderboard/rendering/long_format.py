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
    lines = [json.dumps(_plain(record), allow_nan=False) for record in records]
    return "[\n" + ",\n".join(lines) + "\n]\n"


def as_csv(kind: type, records: Sequence[Any]) -> str:
    """Return a head line and a line for each record of the dataclass ``kind``."""
    out = io.StringIO()
    writer = csv.DictWriter(out, [f.name for f in fields(kind)], lineterminator="\n")
    writer.writeheader()
    for record in records:
        row = _plain(record)
        writer.writerow(
            {k: escape.spreadsheet(v) if isinstance(v, str) else v for k, v in row.items()}
        )
    return out.getvalue()


def _plain(record: Any) -> dict[str, Any]:
    row = {f.name: getattr(record, f.name) for f in fields(record)}
    return {k: None if isinstance(v, float) and math.isnan(v) else v for k, v in row.items()}
