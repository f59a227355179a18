"""One table for people, independent of the output format."""

from dataclasses import dataclass

from benchnav.leaderboard.rendering.cell import Cell


@dataclass(frozen=True)
class Section:
    """A table: title, headings, rows, and the notes below it."""

    chapter: str  # shared by adjacent tables: a condition, or a price
    title: str
    name: tuple[str, ...]  # distinguishes the table from all others; parts may be empty
    headings: tuple[Cell, ...]
    rows: tuple[tuple[Cell, ...], ...]
    notes: tuple[str, ...]
