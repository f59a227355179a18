"""JSON that says the sha256 of all else that it says: no flipped bit in it goes unseen."""

import hashlib
import json
from collections.abc import Mapping
from typing import Any

from benchnav.store.bounded import bounded_json

KEY = "sha256"


def dump(said: Mapping[str, Any]) -> str:
    """The text of an object, with `KEY` last."""
    return json.dumps({**said, KEY: _sum(said)}, indent=1, ensure_ascii=False) + "\n"


def load(text: str) -> dict[str, Any]:
    """The object that was dumped, without `KEY`.

    What was written before there was a `KEY` is taken as it is: the caller must know every key.

    Raises ValueError where the text is no such object.
    """
    fields = bounded_json.load(text)
    if not isinstance(fields, dict):
        raise ValueError("it is no JSON object")
    if KEY in fields and fields.pop(KEY) != _sum(fields):
        raise ValueError(f"it was changed: its {KEY} is another")
    return fields


def _sum(said: Mapping[str, Any]) -> str:
    try:
        text = json.dumps(said, sort_keys=True, separators=(",", ":"))
    except RecursionError:
        raise ValueError("it is nested too deep") from None
    return hashlib.sha256(text.encode()).hexdigest()
