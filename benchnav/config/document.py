"""A YAML file as plain data that still knows on which line everything stands."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

PathKey = str | int


@dataclass
class Place:
    """Line of one node, and the places of what it holds."""

    line: int
    children: dict[PathKey, "Place"] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Document:
    """Plain Python data (dict, list, str, int, float, bool, None) and where it stands."""

    name: str  # file name, as messages print it
    data: Any
    place: Place

    def line(self, path: Sequence[PathKey]) -> int:
        """Line (from 1) of the node at ``path``, or of its nearest ancestor that exists."""
        place = self.place
        for key in path:
            child = place.children.get(key)
            if child is None:
                break
            place = child
        return place.line

    def where(self, path: Sequence[PathKey] = ()) -> str:
        """``file:line: a.b[0].c`` (without the path where it is empty)."""
        text = dotted(path)
        at = f"{self.name}:{self.line(path)}:"
        return f"{at} {text}" if text else at


def dotted(path: Sequence[PathKey]) -> str:
    """``('teams', 0, 'radius')`` → ``teams[0].radius``."""
    text = ""
    for key in path:
        if isinstance(key, int):
            text += f"[{key}]"
        else:
            text += f".{shown(key)}" if text else shown(key)
    return text


def shown(value: object, limit: int = 60) -> str:
    """A value as messages print it: short, on one line, text without its quotes."""
    text = value if isinstance(value, str) else repr(value)
    text = "".join(c if c.isprintable() else "?" for c in text[: limit + 1])
    return text if len(text) <= limit else text[:limit] + "…"
