"""Figures: shared style, and writing to files."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, TypeGuard

from benchnav.errors import MissingExtraError
from benchnav.system.plain_file import writing
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
    """Whether the suffix of a file is that of a picture."""
    return path is not None and path.suffix.lower() in SUFFIXES


def blank(width: float, height: float) -> Figure:
    """Return an empty figure [inch]. Raises MissingExtraError if matplotlib is not installed."""
    cache = user_cache().path
    if not home_is_usable() and cache is not None:
        # Without this folder, matplotlib warns and creates a new one each time.
        os.environ.setdefault("MPLCONFIGDIR", str(cache / "matplotlib"))
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise MissingExtraError("A picture", "view") from error
    return Figure(figsize=(width, height), layout="constrained")


def plain(axes: Axes) -> None:
    """Hide the top and right frame of the axes, and draw a grid."""
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    axes.grid(alpha=0.25, linewidth=0.6)
    axes.set_axisbelow(True)


def save(figure: Figure, path: Path) -> None:
    """Write a figure in the format of the suffix of ``path``; equal figures give equal bytes.

    Raises StoreError if the file cannot be written.
    """
    from matplotlib import rc_context

    with writing(path), rc_context({"svg.hashsalt": "benchnav", "svg.fonttype": "none"}):
        figure.savefig(path, dpi=DPI, metadata=_UNDATED[path.suffix.lower()])
