"""A leaderboard fitted to the width of a terminal."""

from collections.abc import Iterator, Sequence
from io import StringIO
from itertools import groupby
from typing import TYPE_CHECKING

from benchnav.leaderboard.record import Leaderboard
from benchnav.leaderboard.rendering.cell import Cell
from benchnav.leaderboard.rendering.layout import legend, sections
from benchnav.leaderboard.rendering.section import Section
from benchnav.text.visible import visible

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, RenderableType
    from rich.table import Table

GAP = 2  # characters between two columns
NARROWEST_NAMES = 16  # characters that the column of names may always take
SHARE_OF_NAMES = 3  # otherwise, it takes at most 1/3 of the width


class TerminalTables:
    """The tables of a leaderboard for `rich.print`, fitted to the width of the console.

    ``metrics`` and ``columns`` as in `benchnav.leaderboard.render`. Columns that do not fit beside
    each other continue below, with the names repeated.
    """

    def __init__(
        self,
        board: Leaderboard,
        metrics: Sequence[str] | None = None,
        columns: Sequence[str] | None = None,
    ) -> None:
        self._sections = list(sections(board, metrics, columns))
        self._legend = legend(board)

    def __rich_console__(
        self, console: "Console", options: "ConsoleOptions"
    ) -> Iterator["RenderableType"]:
        """Yield headings, tables and notes, from the most general table to the most special."""
        from rich.rule import Rule
        from rich.text import Text

        for chapter, tables in groupby(self._sections, key=lambda section: section.chapter):
            yield Rule(Text(visible(chapter), style="bold"), align="left", style="none")
            for section in tables:
                yield Text(visible(section.title), style="bold")
                for table in _tables(section, options.max_width):
                    yield table
                    yield Text("")
                if section.notes:
                    yield from (Text(visible(note)) for note in section.notes)
                    yield Text("")
        yield from (Text(visible(line), style="dim") for line in self._legend)


def terminal(
    board: Leaderboard,
    metrics: Sequence[str] | None = None,
    columns: Sequence[str] | None = None,
    *,
    width: int,
    styled: bool = False,
) -> str:
    """Return the tables as lines of at most ``width`` characters.

    ``styled`` adds escape sequences for bold and dim text. Text from plugins and files is made
    visible first, so no other escape sequence occurs.
    """
    from rich.console import Console

    console = Console(
        file=StringIO(), width=width, force_terminal=styled, highlight=False, markup=False,
        emoji=False, legacy_windows=False, color_system="auto" if styled else None,
    )  # fmt: skip
    with console.capture() as capture:
        console.print(TerminalTables(board, metrics, columns))
    return "\n".join(line.rstrip() for line in capture.get().splitlines()) + "\n"


def _tables(section: Section, width: int) -> Iterator["Table"]:
    """Yield one table, or several in sequence if the columns do not fit side by side."""
    from rich.cells import cell_len

    columns = zip(section.headings, *section.rows, strict=True)
    widths = [max(cell_len(visible(part.text)) for part in column) for column in columns]
    widths[0] = min(widths[0], max(NARROWEST_NAMES, width // SHARE_OF_NAMES))
    for block in _blocks(widths, width):
        table = _table(section, block, widths)
        if table.row_count or block[0] == 1:
            yield table


def _blocks(widths: Sequence[int], width: int) -> Iterator[list[int]]:
    """Yield groups of columns that fit beside the names; at least one column each."""
    block, used = list[int](), widths[0]
    for column in range(1, len(widths)):
        needed = GAP + widths[column]
        if block and used + needed > width:
            yield block
            block, used = [], widths[0]
        block.append(column)
        used += needed
    yield block


def _table(section: Section, block: Sequence[int], widths: Sequence[int]) -> "Table":
    """Return the columns of a block; a table that continues another one has no empty rows."""
    from rich import box
    from rich.table import Table

    table = Table(box=box.HORIZONTALS, show_edge=False, padding=(0, GAP - 1, 0, 0), pad_edge=False)
    for column in (0, *block):
        table.add_column(_text(section.headings[column]), max_width=widths[column], overflow="fold")
    for row in section.rows:
        if block[0] == 1 or any(row[column].text for column in block):
            table.add_row(*(_text(row[column]) for column in (0, *block)))
    return table


def _text(cell: Cell) -> "RenderableType":
    from rich.text import Text

    return Text(visible(cell.text), style="bold" if cell.bold else "")
