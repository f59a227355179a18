"""Render a leaderboard as Markdown, CSV, LaTeX, HTML, JSON, or text for a terminal."""

import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from itertools import groupby
from typing import Literal

from benchnav.errors import UsageError, did_you_mean
from benchnav.leaderboard.columns import choose, choose_columns
from benchnav.leaderboard.record import Leaderboard, Record
from benchnav.leaderboard.rendering import escape
from benchnav.leaderboard.rendering.cell import Cell
from benchnav.leaderboard.rendering.latex import latex_document
from benchnav.leaderboard.rendering.layout import legend, sections
from benchnav.leaderboard.rendering.long_format import as_csv, as_json
from benchnav.leaderboard.rendering.matrix import matrix_sections
from benchnav.leaderboard.rendering.section import Section
from benchnav.leaderboard.rendering.terminal import terminal

Format = Literal["markdown", "csv", "latex", "html", "json", "terminal"]
Metrics = Sequence[str] | None


def render(
    board: Leaderboard,
    format: str,
    metrics: Sequence[str] | None = None,
    columns: Sequence[str] | None = None,
) -> str:
    """Return the leaderboard as text that ends with a line break.

    Markdown, LaTeX and HTML show a few ``metrics`` by default, and all for ``["all"]``;
    LaTeX shows each as a matrix of navigators and scenarios. ``columns`` replaces ``metrics`` and
    gives the columns of every table, in this order: metrics and the names of
    `benchnav.leaderboard.columns.NAMES`. CSV and JSON are tidy, one record each with every field,
    and contain all metrics unless ``metrics`` or ``columns`` name some. "terminal" fits the tables
    to the width of the terminal, with bold text if standard output is a terminal.
    Raises UsageError for an unknown format, metric or column, and for both metrics and columns.
    """
    if format not in _RENDERERS:
        raise UsageError(
            f"The format must be one of {', '.join(_RENDERERS)}. Got {format!r} instead."
            f"{did_you_mean(format, _RENDERERS)}"
        )
    if columns is not None:
        if metrics is not None:
            raise UsageError("Columns name their metrics. Got metrics, too: name them as columns.")
        columns = choose_columns(board.metrics, columns)
    return _RENDERERS[format](board, metrics, columns)


def _chosen(board: Leaderboard, metrics: Metrics, columns: Metrics) -> list[Record]:
    if columns is not None:
        metrics = [name for name in columns if name in board.metrics]
    shown = set(choose(board.metrics, ["all"] if metrics is None else metrics))
    return [record for record in board.records if record.metric in shown]


def _json(board: Leaderboard, metrics: Metrics, columns: Metrics) -> str:
    return as_json(_chosen(board, metrics, columns))


def _csv(board: Leaderboard, metrics: Metrics, columns: Metrics) -> str:
    return as_csv(Record, _chosen(board, metrics, columns))


def _chapters(
    board: Leaderboard, metrics: Metrics, columns: Metrics
) -> Iterator[tuple[str, list[Section]]]:
    """Yield the tables of each condition, then those of each price."""
    for chapter, tables in groupby(sections(board, metrics, columns), key=lambda s: s.chapter):
        yield chapter, list(tables)


def _markdown(board: Leaderboard, metrics: Metrics, columns: Metrics) -> str:
    blocks = []
    for chapter, tables in _chapters(board, metrics, columns):
        blocks += [f"## {escape.markdown(chapter)}\n", *map(_markdown_table, tables)]
    return "\n".join([*blocks, *(f"{line}  " for line in legend(board)), ""])


def _markdown_table(section: Section) -> str:
    def text(cell: Cell) -> str:
        return f"**{escape.markdown(cell.text)}**" if cell.bold else escape.markdown(cell.text)

    head = [text(heading) for heading in section.headings]
    body = [[text(cell) for cell in row] for row in section.rows]
    width = [max(map(len, column)) for column in zip(head, *body, strict=True)]
    lines = [f"### {escape.markdown(section.title)}", ""]
    for row in (head, ["-" * max(w, 3) for w in width], *body):
        padded = [cell.ljust(max(w, 3)) for cell, w in zip(row, width, strict=True)]
        lines.append(f"| {' | '.join(padded)} |")
    lines += ["", *(escape.markdown(note) + "  " for note in section.notes)]
    return "\n".join([*lines, ""] if section.notes else lines)


def _terminal(board: Leaderboard, metrics: Metrics, columns: Metrics) -> str:
    width = shutil.get_terminal_size().columns
    return terminal(board, metrics, columns, width=width, styled=sys.stdout.isatty())


def _latex(board: Leaderboard, metrics: Metrics, columns: Metrics) -> str:
    """Return matrices of the leading metric or of ``metrics``; tables if ``columns`` are given."""
    if columns is not None:
        return latex_document(list(sections(board, None, columns)), legend(board))
    shown = choose(board.metrics, metrics)[: 1 if metrics is None else None]
    return latex_document(list(matrix_sections(board, shown)), legend(board))


_STYLE = """
:root{color-scheme:light dark}
body{font:15px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:75rem;padding:0 1rem;
overflow-wrap:anywhere}
div{overflow-x:auto}
table{border-collapse:separate;border-spacing:0;font-variant-numeric:tabular-nums}
th,td{padding:.25rem .75rem;text-align:right;white-space:nowrap;border-bottom:1px solid #8884}
th:first-child,td:first-child{text-align:left;position:sticky;left:0;background:Canvas}
h2{margin-top:2.5rem}
h3{font-size:1.05rem;margin-top:1.5rem}
p{font-size:.9rem}
@media (max-width:40rem){
th,td{padding:.25rem .5rem}
th:first-child,td:first-child{white-space:normal;width:7.5rem;min-width:7.5rem;
border-right:1px solid #8884}
}
"""  # the first column, which names the row, stays in sight where a table scrolls sideways


def html_fragment(board: Leaderboard, metrics: Metrics = None, columns: Metrics = None) -> str:
    """Return the tables and the legend as HTML without a page around them, for a notebook."""
    body = []
    for chapter, tables in _chapters(board, metrics, columns):
        body.append(f"<h2>{escape.html(chapter)}</h2>")
        body += [part for section in tables for part in _html_table(section)]
    return "\n".join([*body, *(f"<p>{escape.html(line)}</p>" for line in legend(board))])


def _html(board: Leaderboard, metrics: Metrics, columns: Metrics) -> str:
    head = (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width">'
        f"<title>Leaderboard</title><style>{_STYLE}</style></head><body>\n<h1>Leaderboard</h1>"
    )
    return "\n".join([head, html_fragment(board, metrics, columns), "</body></html>", ""])


def _html_table(section: Section) -> list[str]:
    def cell(part: Cell) -> str:
        inner = escape.html(part.text)
        return f"<td><strong>{inner}</strong></td>" if part.bold else f"<td>{inner}</td>"

    head = "".join(f"<th>{escape.html(heading.text)}</th>" for heading in section.headings)
    return [
        f"<h3>{escape.html(section.title)}</h3>",
        f"<div><table><thead><tr>{head}</tr></thead><tbody>",
        *(f"<tr>{''.join(map(cell, row))}</tr>" for row in section.rows),
        "</tbody></table></div>",
        *(f"<p>{escape.html(note)}</p>" for note in section.notes),
    ]


_RENDERERS: dict[str, Callable[[Leaderboard, Metrics, Metrics], str]] = {
    "markdown": _markdown,
    "csv": _csv,
    "latex": _latex,
    "html": _html,
    "json": _json,
    "terminal": _terminal,
}
