"""Colours of 3-D recordings: those of the pages and figures."""

from benchnav.arena.solid import Kind
from benchnav.drawing.top_view import FILL, TEAMS

Color = tuple[float, float, float]  # red, green, blue in [0, 1]


def color_of_kind(kind: Kind) -> Color:
    """Return the colour of walls and obstacles."""
    return _rgb(FILL[kind])


def color_of_team(team: int) -> Color:
    """Return the colour of a team's agents."""
    return _rgb(TEAMS[team % len(TEAMS)])


def _rgb(text: str) -> Color:
    red, green, blue = (int(text[n : n + 2], 16) / 255.0 for n in (1, 3, 5))
    return red, green, blue
