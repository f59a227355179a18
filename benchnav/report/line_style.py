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

    @property
    def swatch(self) -> str:
        """The CSS classes of the square before its name: it is hollow where a colour repeats."""
        return "swatch" if self.dash == DASHES[0] else "swatch hollow"


def line_styles(navigators: Sequence[str]) -> dict[str, LineStyle]:
    """Return a style for each navigator; where colours repeat, dashes and marks differ."""
    return {
        name: LineStyle(
            NAVIGATORS[k % len(NAVIGATORS)],
            DASHES[k // len(NAVIGATORS) % len(DASHES)],
            SYMBOLS[k % len(SYMBOLS)],
        )
        for k, name in enumerate(navigators)
    }
