"""Read YAML that may be malformed, enormous, recursive or hostile.

The file is read as a stream of events by an iterative loop, never recursively,
and only plain data is constructed. Scalars follow YAML 1.2's core schema,
without octal and hexadecimal numbers: ``yes``, ``no``, ``012`` and ``0x1F`` are text.
Keys are always text.
"""

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from benchnav.config.document import Document, PathKey, Place, shown
from benchnav.config.validation import validate
from benchnav.errors import ScenarioError
from benchnav.system.plain_file import read_file

MAX_BYTES = 1 << 20
MAX_DEPTH = 32
MAX_NODES = 50_000
MAX_KEY = 200  # characters

_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # only its parser is used
_INT = re.compile(r"[-+]?(0|[1-9][0-9]*)")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|(0|[1-9][0-9]*)(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_WORDS: dict[str, Any] = {
    "": None, "~": None, "null": None, "Null": None, "NULL": None,
    "true": True, "True": True, "TRUE": True,
    "false": False, "False": False, "FALSE": False,
    ".nan": float("nan"), ".NaN": float("nan"), ".NAN": float("nan"),
    ".inf": float("inf"), ".Inf": float("inf"), ".INF": float("inf"),
    "+.inf": float("inf"), "-.inf": float("-inf"), "-.Inf": float("-inf"),
}  # fmt: skip

__all__ = [
    "MAX_BYTES", "MAX_DEPTH", "MAX_NODES", "document_of", "read_yaml", "read_yaml_text", "validate",
]  # fmt: skip


def read_yaml(path: Path | str) -> Document:
    """Return the one document in the file ``path``.

    Raises:
        ScenarioError: the file is missing, too large, not UTF-8, or not the YAML described above.
    """
    path = Path(path)
    try:
        raw = read_file(path, MAX_BYTES)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ScenarioError(f"{shown(str(path), 300)}:1: cannot be read: {reason}.") from None
    if len(raw) > MAX_BYTES:
        raise ScenarioError(f"{path}:1: the file must be at most {MAX_BYTES} bytes; it is larger.")
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise ScenarioError(
            f"{path}:{line}: the file must be UTF-8; byte {error.start} is {raw[error.start]:#04x}."
        ) from None
    return read_yaml_text(text, str(path))


def document_of(content: Mapping[str, Any], name: str) -> Document:
    """Return the content of a file, given as a mapping; messages use ``name`` as the file name.

    Raises ScenarioError where a value is not plain data, or as `read_yaml_text`.
    """
    try:
        text = yaml.safe_dump(dict(content), sort_keys=False, allow_unicode=True)
    except yaml.representer.RepresenterError as error:
        strange = shown(error.args[-1])
        raise ScenarioError(
            f"{name}: every value must be a mapping, a list, text, a number, true, false or None."
            f" Got {strange} instead."
        ) from None
    return read_yaml_text(text, name)


def read_yaml_text(text: str, name: str) -> Document:
    """Return the one document in ``text``; messages use ``name`` as the file name.

    Raises:
        ScenarioError: it is too large, or not the YAML that this module reads.
    """
    if len(text) > MAX_BYTES:
        raise ScenarioError(f"{name}:1: the text must be at most {MAX_BYTES} characters.")
    builder = _Builder(name)
    try:
        text.encode()
        for event in _events(text):
            builder.take(event)
    except UnicodeEncodeError as error:
        line = text.count("\n", 0, error.start) + 1
        raise ScenarioError(f"{name}:{line}: the text contains half a surrogate pair.") from None
    except yaml.YAMLError as error:
        raise ScenarioError(f"{name}:{_line_of(error, text)}: {_problem(error)}.") from None
    return Document(name, builder.data, builder.place)


def _events(text: str) -> Iterator[Any]:
    loader = _LOADER(text)
    try:
        while loader.check_event():
            yield loader.get_event()
    finally:
        loader.dispose()


def _line_of(error: yaml.YAMLError, text: str) -> int:
    mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
    if mark is not None:
        return min(int(mark.line), text.count("\n")) + 1
    position = getattr(error, "position", None)
    return text.count("\n", 0, position) + 1 if isinstance(position, int) else 1


def _problem(error: yaml.YAMLError) -> str:
    problem = getattr(error, "problem", None) or getattr(error, "reason", None) or str(error)
    return "not valid YAML: " + shown(" ".join(str(problem).split()), 200)


class _Builder:
    """Turns events into data with an explicit stack of open containers."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.data: Any = None
        self.place = Place(1)
        self._open: list[tuple[Any, Place]] = []
        self._key: list[str | None] = []  # pending key of each open mapping
        self._nodes = 0
        self._documents = 0

    def take(self, event: Any) -> None:
        line = event.start_mark.line + 1
        match event:
            case yaml.DocumentStartEvent():
                self._documents += 1
                self._demand(self._documents == 1, line, "the file must hold one document")
            case yaml.AliasEvent():
                self._fail(line, f"aliases are not allowed; got *{shown(event.anchor)}")
            case yaml.ScalarEvent():
                self._node(event, line)
                self._scalar(event, line)
            case yaml.MappingStartEvent():
                self._enter({}, event, line)
            case yaml.SequenceStartEvent():
                self._enter([], event, line)
            case yaml.MappingEndEvent() | yaml.SequenceEndEvent():
                self._open.pop()
                self._key.pop()
            case _:
                pass

    def _fail(self, line: int, problem: str) -> None:
        raise ScenarioError(f"{self.name}:{line}: {problem}.")

    def _demand(self, holds: bool, line: int, problem: str) -> None:
        if not holds:
            self._fail(line, problem)

    def _node(self, event: Any, line: int) -> None:
        self._nodes += 1
        self._demand(self._nodes <= MAX_NODES, line, f"at most {MAX_NODES} values are allowed")
        if event.anchor is not None:
            self._fail(line, f"anchors are not allowed; got &{shown(event.anchor)}")
        if event.tag is not None:
            self._fail(line, f"tags are not allowed; got {shown(event.tag)}")

    def _enter(self, container: Any, event: Any, line: int) -> None:
        self._node(event, line)
        self._demand(
            len(self._open) < MAX_DEPTH, line, f"values may be nested at most {MAX_DEPTH} deep"
        )
        if self._wants_key():
            self._fail(line, "a key must be text; got a list or a mapping")
        self._open.append((container, self._attach(container, line)))
        self._key.append(None)

    def _wants_key(self) -> bool:
        return bool(self._open) and isinstance(self._open[-1][0], dict) and self._key[-1] is None

    def _scalar(self, event: Any, line: int) -> None:
        if self._wants_key():
            key = event.value
            self._demand(len(key) <= MAX_KEY, line, f"a key has at most {MAX_KEY} characters")
            if key in self._open[-1][0]:
                first = self._open[-1][1].children[key].line
                self._fail(line, f"the key {shown(key)!r} is repeated; first in line {first}")
            self._key[-1] = key
            return
        plain = event.style is None or event.style == ""
        try:
            value = _plain(event.value) if plain else event.value
        except ValueError:
            self._fail(line, f"the number {shown(event.value, 20)} has too many digits")
        self._attach(value, line)

    def _attach(self, value: Any, line: int) -> Place:
        place = Place(line)
        if not self._open:
            self.data, self.place = value, place
            return place
        container, around = self._open[-1]
        at: PathKey
        if isinstance(container, list):
            at = len(container)
            container.append(value)
        else:
            at = str(self._key[-1])
            self._key[-1] = None
            container[at] = value
        around.children[at] = place
        return place


def _plain(text: str) -> Any:
    """Return the value of an unquoted scalar; ValueError for a number of absurd length."""
    if text in _WORDS:
        return _WORDS[text]
    if _INT.fullmatch(text):
        if len(text) > 300:
            raise ValueError
        return int(text)
    return float(text) if _FLOAT.fullmatch(text) else text
