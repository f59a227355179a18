"""Messages for the user, on standard error."""

import sys

from benchnav.text.visible import visible_lines


def message(text: str) -> None:
    """Print a message; characters that control a terminal are replaced."""
    sys.stderr.write(visible_lines(text) + "\n")
    sys.stderr.flush()


def silent(text: str) -> None:
    """Print nothing."""
