"""The path of a run, as a caller gives it."""

import os
from pathlib import Path

from benchnav.errors import UsageError

RunPath = str | os.PathLike[str]


def run_path(given: RunPath) -> Path:
    """Return the path of a run's folder or pack. Raises UsageError for other types."""
    text = os.fspath(given) if isinstance(given, str | os.PathLike) else given
    if isinstance(text, str) and text and "\0" not in text:
        return Path(text)
    got = repr(text) if isinstance(text, str) else f"a {type(given).__name__}"
    raise UsageError(
        f"A run must be named by the path of its folder, as text or as a pathlib.Path. Got {got}"
        " instead."
    )
