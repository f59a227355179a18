"""JSON objects with the sha256 of their content, so that every flipped bit is detected."""

import hashlib
import json
from collections.abc import Mapping
from typing import Any

from benchnav.store.bounded import bounded_json

KEY = "sha256"


def dump(fields: Mapping[str, Any]) -> str:
    """Return the text of an object, with `KEY` last."""
    return json.dumps({**fields, KEY: _sum(fields)}, indent=1, ensure_ascii=False) + "\n"


def load(text: str) -> dict[str, Any]:
    """Return the object in a dumped text, without `KEY`.

    A text from before `KEY` existed is accepted unchecked: the caller must know every key.

    Raises ValueError if the text is not such an object.
    """
    fields = bounded_json.load(text)
    if not isinstance(fields, dict):
        raise ValueError("it is not a JSON object")
    if KEY in fields and fields.pop(KEY) != _sum(fields):
        raise ValueError(f"it was changed: its {KEY} differs from the sum of its content")
    return fields


def _sum(fields: Mapping[str, Any]) -> str:
    try:
        text = json.dumps(fields, sort_keys=True, separators=(",", ":"))
    except RecursionError:
        raise ValueError("it is nested too deep") from None
    return hashlib.sha256(text.encode()).hexdigest()
