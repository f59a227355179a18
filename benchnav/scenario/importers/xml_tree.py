"""A small XML tree with line numbers, of files that strangers wrote."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.parsers import expat

from benchnav.config.document import shown
from benchnav.errors import WorldFileError
from benchnav.system.plain_file import read_file

MAX_BYTES = 64 << 20
MAX_ELEMENTS = 1_000_000
MAX_DEPTH = 100


@dataclass(eq=False)
class Element:
    """An element, its attributes and children."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list["Element"] = field(default_factory=list)
    pieces: list[str] = field(default_factory=list)  # of its text

    @property
    def text(self) -> str:
        """Its own text without white space around it."""
        return "".join(self.pieces).strip()

    def all(self, tag: str) -> Iterator["Element"]:
        """Yield the children of this name."""
        return (child for child in self.children if child.tag == tag)

    def first(self, tag: str) -> "Element | None":
        """Return the first child of this name."""
        return next(self.all(tag), None)


def bytes_of(path: Path, what: str) -> bytes:
    """Return the content of a file of limited size. Raises WorldFileError."""
    try:
        raw = read_file(path, MAX_BYTES)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise WorldFileError(f"{path}:1: {what} cannot be read: {reason}.") from None
    if len(raw) > MAX_BYTES:
        raise WorldFileError(f"{path}:1: {what} must have at most {MAX_BYTES >> 20} MiB.")
    return raw


def read_xml(path: Path, root: str) -> Element:
    """Return the root element of an XML file, which must be called ``root``.

    Definitions of entities and document types are refused: they can expand without limit, and
    name other files. Raises WorldFileError with the line.
    """
    raw = bytes_of(path, "the file")
    top = Element("", {}, 1)
    stack, count = [top], [0]
    parser: Any = expat.ParserCreate()
    parser.buffer_text = True

    def start(tag: str, attributes: dict[str, str]) -> None:
        count[0] += 1
        line = parser.CurrentLineNumber
        if count[0] > MAX_ELEMENTS or len(stack) > MAX_DEPTH:
            raise WorldFileError(
                f"{path}:{line}: the file must have at most {MAX_ELEMENTS} elements, nested at most"
                f" {MAX_DEPTH} deep."
            )
        element = Element(tag, attributes, line)
        stack[-1].children.append(element)
        stack.append(element)

    def doctype(*_: object) -> None:
        raise WorldFileError(
            f"{path}:{parser.CurrentLineNumber}: the file may not define a document type or"
            " entities. Remove the definition."
        )

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda tag: stack.pop()
    parser.CharacterDataHandler = lambda text: stack[-1].pieces.append(text)
    parser.StartDoctypeDeclHandler = parser.EntityDeclHandler = doctype
    try:
        parser.Parse(raw, True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        code = getattr(error, "code", None)
        reason = expat.ErrorString(code) if code is not None else str(error)
        line = getattr(error, "lineno", 1)
        raise WorldFileError(f"{path}:{line}: the file must be XML; {reason}.") from None
    (found,) = top.children
    if found.tag != root:
        raise WorldFileError(
            f"{path}:{found.line}: the first element must be <{root}>; got <{shown(found.tag)}>."
        )
    return found
