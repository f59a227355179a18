"""A YAML file as plain data, with the line of every node."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

PathKey = str | int


@dataclass
class Place:
    """The line of a node, and the places of its children."""

    line: int
    children: dict[PathKey, "Place"] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Document:
    """Plain Python data (dict, list, str, int, float, bool, None) and its places in the file."""

    name: str  # file name, as in messages
    data: Any
    place: Place

    def line(self, path: Sequence[PathKey]) -> int:
        """Return the line (from 1) of the node at ``path``, or of its nearest existing ancestor."""
        place = self.place
        for key in path:
            child = place.children.get(key)
            if child is None:
                break
            place = child
        return place.line

    def where(self, path: Sequence[PathKey] = ()) -> str:
        """Return ``file:line: a.b[0].c`` (no path if it is empty)."""
        text = dotted(path)
        at = f"{self.name}:{self.line(path)}:"
        return f"{at} {text}" if text else at


def dotted(path: Sequence[PathKey]) -> str:
    """Return a path as text: ``('teams', 0, 'radius')`` → ``teams[0].radius``."""
    text = ""
    for key in path:
        if isinstance(key, int):
            text += f"[{key}]"
        else:
            text += f".{shown(key)}" if text else shown(key)
    return text


def shown(value: object, limit: int = 60) -> str:
    """Return a value as in messages: short, on one line, strings without quotes."""
    text = value if isinstance(value, str) else repr(value)
    text = "".join(c if c.isprintable() else "?" for c in text[: limit + 1])
    return text if len(text) <= limit else text[:limit] + "…"
