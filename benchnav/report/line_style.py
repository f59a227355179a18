"""The colour, dash and mark of each navigator, the same on all pages of a report."""

from collections.abc import Sequence
from dataclasses import dataclass

from benchnav.drawing.palette import NAVIGATORS

DASHES = ("solid", "dash", "dot", "dashdot")
SYMBOLS = ("circle", "square", "diamond", "triangle-up", "cross", "x", "star", "hexagon")


@dataclass(frozen=True)
class LineStyle:
    """How figures draw a navigator. Names are those of plotly."""

    color: str  # "#rrggbb"
    dash: str
    symbol: str
    swatch: str  # CSS classes of the square before its name; hollow where a colour repeats


def line_styles(navigators: Sequence[str]) -> dict[str, LineStyle]:
    """Return a style for each navigator; equal colours have different dashes.

    Neighbours in the palette differ in dash and mark too, so that figures need no colours.
    """
    return {
        name: LineStyle(
            NAVIGATORS[k % len(NAVIGATORS)],
            DASHES[(k + k // len(NAVIGATORS)) % len(DASHES)],
            SYMBOLS[k % len(SYMBOLS)],
            "swatch" if k < len(NAVIGATORS) else "swatch hollow",
        )
        for k, name in enumerate(navigators)
    }
