"""Long reasons of a table as numbered notes below it, so that no reason widens a column."""

from dataclasses import replace

from benchnav.leaderboard.rendering.cell import Cell
from benchnav.leaderboard.rendering.section import Section

LONGEST = 24  # largest number of characters of a reason that stays in its cell


def with_footnotes(section: Section) -> Section:
    """Return the table with each long reason replaced by ``n/a [1]``, and the reasons as notes.

    Equal reasons share a number.
    """
    numbers: dict[str, int] = {}
    rows = tuple(tuple(_short(cell, numbers) for cell in row) for row in section.rows)
    notes = tuple(f"[{number}] {reason}" for reason, number in numbers.items())
    return replace(section, rows=rows, notes=(*notes, *section.notes))


def _short(cell: Cell, numbers: dict[str, int]) -> Cell:
    if not cell.text.startswith("n/a (") or len(cell.text) <= LONGEST:
        return cell
    reason = cell.text.removeprefix("n/a (").removesuffix(")")
    number = numbers.setdefault(reason, len(numbers) + 1)
    return replace(cell, text=f"n/a [{number}]")
