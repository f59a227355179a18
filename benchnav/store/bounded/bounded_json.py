"""JSON from anybody: what reading it takes is bounded before it is read."""

import json
import re
from collections import Counter
from pathlib import Path
from typing import Any

from benchnav.config.document import shown

MOST_CONTAINERS = 1_000_000  # lists and objects, of which an empty one takes 64 bytes for its two

MOST_DEPTH = 100  # of lists and objects within each other
_SURROGATE = re.compile("[\ud800-\udfff]")


def read_text(path: Path, most: int) -> str:
    """Return the text of a file of at most ``most`` bytes.

    Raises OSError where it cannot be read, ValueError where it is longer or no UTF-8.
    """
    with path.open("rb") as file:
        content = file.read(most + 1)
    if len(content) > most:
        raise ValueError(f"it must have at most {most} bytes, and has more")
    return content.decode()


def load(text: str, containers: int = MOST_CONTAINERS) -> Any:
    """Return the value in ``text``, with at most so many lists and objects.

    Raises ValueError where it is no JSON, holds more, is nested too deep, or gives a key twice.
    """
    if text.count("[") + text.count("{") > containers:
        raise ValueError(f"it must have at most {containers} lists and objects, and has more")
    try:
        value = json.loads(text, object_pairs_hook=_object)
    except RecursionError:
        raise ValueError("it is nested too deep") from None
    _require_depth(value, MOST_DEPTH)
    if "\\u" in text and _SURROGATE.search(json.dumps(value, ensure_ascii=False)):
        raise ValueError("it holds half a character: a lone surrogate")
    return value


def _require_depth(value: Any, most: int) -> None:
    """Raise ValueError where lists and objects are nested deeper than ``most``."""
    if not most:
        raise ValueError(f"it is nested more than {MOST_DEPTH} deep")
    below = value.values() if isinstance(value, dict) else value
    for item in below if isinstance(below, list) or isinstance(value, dict) else ():
        if isinstance(item, list | dict):
            _require_depth(item, most - 1)


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        (name, _), *_ = Counter(name for name, _ in pairs).most_common(1)
        raise ValueError(f"it has the key {shown(name)!r} twice in one object")
    return found
