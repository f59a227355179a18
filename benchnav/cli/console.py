"""Where words go: results to stdout, talk to stderr."""

import sys
from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from benchnav.errors import StoreError, UsageError, did_you_mean
from benchnav.system.plain_file import require_writable
from benchnav.system.streams import drop
from benchnav.text.visible import visible_lines

if TYPE_CHECKING:
    from benchnav.store.runs.spans import Span

E = TypeVar("E", bound=StrEnum)


def say(text: str) -> None:
    """Talk; what controls a terminal is marked."""
    sys.stderr.write(visible_lines(text) + "\n")
    sys.stderr.flush()


def put(text: str) -> None:
    """A result; what controls a terminal is marked. Raises StoreError where it cannot be written.

    A reader that leaves early has seen enough: the rest is dropped, and the work goes on.
    """
    try:
        sys.stdout.write(visible_lines(text) + "\n")
        sys.stdout.flush()
    except OSError as error:
        drop(sys.stdout)
        if not isinstance(error, BrokenPipeError):
            raise StoreError(
                "Standard output must be writable, or the result is lost."
                f" The system says: {error.strerror}."
            ) from error


def columns(rows: Sequence[Sequence[str]]) -> str:
    """Rows as columns of equal width, two spaces apart."""
    if not rows:
        return ""
    widths = [max(len(row[c]) for row in rows) for c in range(len(rows[0]))]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    )


def spans(seeds: Sequence["Span"]) -> str:
    """Spans of seeds in few words: ``seeds 0–4, 7``."""
    shown = ", ".join("–".join(map(str, sorted({a, b - 1}))) for a, b in seeds[:4])
    several = len(seeds) > 1 or seeds[0][1] - seeds[0][0] > 1
    return f"seed{'s' if several else ''} {shown}{', …' if len(seeds) > 4 else ''}"


def write(path: Path, text: str) -> None:
    """Write a result to a file. Raises StoreError where that cannot be done."""
    try:
        require_writable(path)
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise StoreError(f"{path} must be writable. The system says: {error.strerror}.") from error


def deliver(text: str, out: Path | None) -> None:
    """A result to stdout, or to a file where one is named."""
    if out is None:
        put(text.rstrip("\n"))
    else:
        write(out, text)
        say(f"{out} is written")


def one_of(kinds: type[E], what: str, said: str) -> E:
    """The member of ``kinds`` that was said. Raises UsageError where there is none."""
    try:
        return kinds(said)
    except ValueError:
        known = [kind.value for kind in kinds]
        raise UsageError(
            f"{what} must be one of {', '.join(known)}. Got {said!r} instead."
            f"{did_you_mean(said, known)}"
        ) from None
