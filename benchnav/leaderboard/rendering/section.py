"""One table for people, whatever it is printed as."""

from dataclasses import dataclass

from benchnav.leaderboard.rendering.cell import Cell


@dataclass(frozen=True)
class Section:
    """Title, head, body and what is to be said below it."""

    chapter: str  # what tables that stand together share: a track, or the price of ignorance
    title: str
    name: tuple[str, ...]  # what tells the table from the others; parts may be empty
    headings: tuple[Cell, ...]
    rows: tuple[tuple[Cell, ...], ...]
    notes: tuple[str, ...]
