"""JSON that says the sha256 of all else that it says: no flipped bit in it goes unseen."""

import hashlib
import json
from collections.abc import Collection, Mapping
from typing import Any

KEY = "sha256"


def dump(said: Mapping[str, Any]) -> str:
    """The text of an object, with `KEY` last."""
    return json.dumps({**said, KEY: _sum(said)}, indent=1, ensure_ascii=False) + "\n"


def load(text: str, known: Collection[str]) -> dict[str, Any]:
    """The object that was dumped, without `KEY`.

    What was written before there was a `KEY` is taken as it is, if all its keys are ``known``.

    Raises ValueError where the text is no such object.
    """
    said = json.loads(text)
    if not isinstance(said, dict):
        raise ValueError("it is no JSON object")
    if KEY in said:
        if said.pop(KEY) != _sum(said):
            raise ValueError(f"it was changed: its {KEY} is another")
    elif strange := sorted(set(said) - set(known)):
        raise ValueError(f"it says {strange[0]!r}, which nobody wrote")
    return said


def _sum(said: Mapping[str, Any]) -> str:
    text = json.dumps(said, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()
