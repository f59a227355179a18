"""A figure on paper: what all pictures share, and how they are written."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, TypeGuard

from benchnav.errors import MissingExtraError, StoreError
from benchnav.system.plain_file import require_writable
from benchnav.system.user_folders import home_is_usable, user_cache

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SUFFIXES = (".png", ".svg", ".pdf")
BLUE, RED, GREY = "#1f6feb", "#d1495b", "#6b7280"
COLOURS = (BLUE, RED, "#2a9d8f", "#8e5aa8", "#e07a3f", "#0f4c5c", "#b0892f", GREY)
DASHES = ("-", "--", ":", "-.")
DPI = 130
_UNDATED = {".png": None, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}


def is_picture(path: Path | None) -> TypeGuard[Path]:
    """True where a file's name asks for a picture."""
    return path is not None and path.suffix.lower() in SUFFIXES


def blank(width: float, height: float) -> Figure:
    """An empty figure [inch]. Raises MissingExtraError where matplotlib is not installed."""
    cache = user_cache().path
    if not home_is_usable() and cache is not None:  # else it warns, and makes a new one each time
        os.environ.setdefault("MPLCONFIGDIR", str(cache / "matplotlib"))
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise MissingExtraError("A picture", "view") from error
    return Figure(figsize=(width, height), layout="constrained")


def plain(axes: Axes) -> None:
    """No frame where nothing is read off."""
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    axes.grid(alpha=0.25, linewidth=0.6)
    axes.set_axisbelow(True)


def save(figure: Figure, path: Path) -> None:
    """Write it as the name's end says; the same figure gives the same bytes.

    Raises StoreError where that cannot be done.
    """
    from matplotlib import rc_context

    try:
        require_writable(path)
        with rc_context({"svg.hashsalt": "benchnav", "svg.fonttype": "none"}):
            figure.savefig(path, dpi=DPI, metadata=_UNDATED[path.suffix.lower()])
    except OSError as error:
        raise StoreError(f"{path} must be writable. The system says: {error.strerror}.") from error
