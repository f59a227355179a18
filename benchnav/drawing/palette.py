"""The colours of worlds in every picture, page and recording; readable for colour-blind people.

The first five colours of teams are from Okabe & Ito 2008, Color Universal Design.
"""

from benchnav.arena.solid import Kind
from benchnav.arena.world import World

PAPER, INK, HIT = "#ffffff", "#22303c", "#cc0033"
FILL = {Kind.WALL: "#36454f", Kind.STATIC: "#b4bec6", Kind.DYNAMIC: "#e07a3f"}
TEAMS = ("#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c6d00", "#7a5195", "#4d4d4d")
NAVIGATORS = (
    "#0072b2", "#d55e00", "#009e73", "#c0619c", "#b07d00", "#3c95cf", "#7d5fb2", "#8a6a4f",
    "#6f7a84", "#1f8a8c", "#b3404a", "#5f8a1f",
)  # fmt: skip
"""Colours of navigators: each has a contrast of at least 3 to white and to a dark page."""


def color_number(world: World, agent: int) -> int:
    """Return the index in `TEAMS` of an agent's colour.

    It is that of the agent's team, or of the agent itself if a single team has few agents.
    """
    single = len(world.teams) == 1 and len(world.agents) <= len(TEAMS)
    return agent if single else int(world.agents.team[agent]) % len(TEAMS)


def agent_color(world: World, agent: int) -> str:
    """Return the colour of an agent."""
    return TEAMS[color_number(world, agent)]


def channels(color: str) -> tuple[int, int, int]:
    """Return red, green and blue from 0 to 255 of ``#rrggbb``."""
    red, green, blue = (int(color[n : n + 2], 16) for n in (1, 3, 5))
    return red, green, blue


def rgb(color: str) -> tuple[float, float, float]:
    """Return red, green and blue in [0, 1] of ``#rrggbb``."""
    red, green, blue = channels(color)
    return red / 255.0, green / 255.0, blue / 255.0
