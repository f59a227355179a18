"""Messages for the user, on standard error."""

import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from benchnav.text.visible import visible_lines

_OPTION = re.compile(r"\b(?:[Tt]he )?option '([a-z][a-z-]*)'")
_flags: ContextVar[bool] = ContextVar("flags", default=False)


@contextmanager
def options_as_flags() -> Iterator[None]:
    """Name options as the command does, --unit, instead of: the option 'unit'."""
    before = _flags.set(True)
    try:
        yield
    finally:
        _flags.reset(before)


def message(text: str) -> None:
    """Print a message; characters that control a terminal are replaced."""
    text = _OPTION.sub(r"--\1", text) if _flags.get() else text
    sys.stderr.write(visible_lines(text) + "\n")
    sys.stderr.flush()


def silent(text: str) -> None:
    """Print nothing."""
