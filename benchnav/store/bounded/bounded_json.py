"""Read untrusted JSON with bounded memory."""

import json
import re
from collections import Counter
from pathlib import Path
from typing import Any

from benchnav.config.document import shown

MAX_CONTAINERS = 1_000_000  # lists and objects; an empty one takes 64 bytes for its two

MAX_DEPTH = 100  # of nested lists and objects
_SURROGATE = re.compile("[\ud800-\udfff]")


def read_text(path: Path, most: int) -> str:
    """Return the text of a file of at most ``most`` bytes.

    Raises OSError if it cannot be read, ValueError if it is longer or not UTF-8.
    """
    with path.open("rb") as file:
        content = file.read(most + 1)
    if len(content) > most:
        raise ValueError(f"it must have at most {most} bytes, and has more")
    return content.decode()


def load(text: str, containers: int = MAX_CONTAINERS) -> Any:
    """Return the value in ``text``, with at most ``containers`` lists and objects.

    Raises ValueError if it is not JSON, is larger, is nested too deep, or repeats a key.
    """
    if text.count("[") + text.count("{") > containers:
        raise ValueError(f"it must have at most {containers} lists and objects, and has more")
    try:
        value = json.loads(text, object_pairs_hook=_object)
    except RecursionError:
        raise ValueError("it is nested too deep") from None
    _require_depth(value, MAX_DEPTH)
    if "\\u" in text and _SURROGATE.search(json.dumps(value, ensure_ascii=False)):
        raise ValueError("it contains a lone surrogate (half a character)")
    return value


def _require_depth(value: Any, most: int) -> None:
    """Raise ValueError if lists and objects are nested deeper than ``most``."""
    if not most:
        raise ValueError(f"it is nested more than {MAX_DEPTH} deep")
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
