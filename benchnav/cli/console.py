"""Where words go: results to stdout, talk to stderr."""

import sys
from enum import StrEnum
from pathlib import Path
from typing import TypeVar

from benchnav.api.messages import message as say
from benchnav.api.text_table import written
from benchnav.errors import StoreError, UsageError, did_you_mean
from benchnav.system.streams import drop
from benchnav.text.visible import visible_lines

__all__ = ["deliver", "one_of", "put", "say"]

E = TypeVar("E", bound=StrEnum)


def put(text: str, safe: bool = False) -> None:
    """Print a result. Characters that control a terminal are marked, unless ``safe`` says that
    all of them are our own. Raises StoreError where it cannot be written.

    A reader that leaves early has seen enough: the rest is dropped, and the work goes on.
    """
    try:
        sys.stdout.write((text if safe else visible_lines(text)) + "\n")
        sys.stdout.flush()
    except OSError as error:
        drop(sys.stdout)
        if not isinstance(error, BrokenPipeError):
            raise StoreError(
                "Standard output must be writable, or the result is lost."
                f" The system says: {error.strerror}."
            ) from error


def deliver(text: str, out: Path | None) -> None:
    """A result to stdout, or to a file where one is named."""
    if out is None:
        put(text.rstrip("\n"))
    else:
        written(text, out)
        say(f"{out} is written")


def one_of(kinds: type[E], what: str, text: str) -> E:
    """Return the member of ``kinds`` called ``text``. Raises UsageError if there is none."""
    try:
        return kinds(text)
    except ValueError:
        known = [kind.value for kind in kinds]
        raise UsageError(
            f"{what} must be one of {', '.join(known)}. Got {text!r} instead."
            f"{did_you_mean(text, known)}"
        ) from None
