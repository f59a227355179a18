"""Output of the command: results to stdout, messages to stderr."""

import sys
from enum import StrEnum
from pathlib import Path
from typing import TypeVar

from benchnav.api.output.messages import message as say
from benchnav.api.output.text_table import written
from benchnav.errors import StoreError, UsageError, did_you_mean
from benchnav.system.streams import drop
from benchnav.text.visible import visible_lines

__all__ = ["deliver", "one_of", "put", "say"]

E = TypeVar("E", bound=StrEnum)


def put(text: str, safe: bool = False) -> None:
    """Print a result to stdout. Raises StoreError if it cannot be written.

    Control characters of terminals are made visible, unless ``safe``: the text then contains only
    our own. If the reader of a pipe closes it early, the rest of the output is dropped without an
    error.
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
    """Write a result to the file ``out``, or to stdout if it is None."""
    if out is None:
        put(text.rstrip("\n"))
    else:
        written(text, out)
        say(f"{out} is written")


def one_of(kinds: type[E], name: str, text: str) -> E:
    """Return the member of ``kinds`` with value ``text``; raises UsageError if there is none."""
    try:
        return kinds(text)
    except ValueError:
        known = [kind.value for kind in kinds]
        raise UsageError(
            f"{name} must be one of {', '.join(known)}. Got {text!r} instead."
            f"{did_you_mean(text, known)}"
        ) from None
