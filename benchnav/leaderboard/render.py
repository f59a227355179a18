"""Leaderboard → Markdown, CSV, LaTeX, HTML, JSON."""

from collections.abc import Callable, Iterator, Sequence
from itertools import groupby
from typing import Literal

from benchnav.errors import UsageError, did_you_mean
from benchnav.leaderboard import escape
from benchnav.leaderboard.cell import Cell
from benchnav.leaderboard.layout import choose, legend, sections
from benchnav.leaderboard.record import Leaderboard, Record
from benchnav.leaderboard.section import Section
from benchnav.leaderboard.tidy import as_csv, as_json

Format = Literal["markdown", "csv", "latex", "html", "json"]


def render(board: Leaderboard, format: str, metrics: Sequence[str] | None = None) -> str:
    """The leaderboard as text that ends with a line break.

    Markdown, LaTeX and HTML show a few ``metrics`` unless told otherwise (``["all"]``:
    all); CSV and JSON are tidy, one record each, and hold all unless told otherwise.
    Raises UsageError for an unknown format or metric.
    """
    if format not in _RENDERERS:
        raise UsageError(
            f"The format must be one of {', '.join(_RENDERERS)}. Got {format!r} instead."
            f"{did_you_mean(format, _RENDERERS)}"
        )
    return _RENDERERS[format](board, metrics)


def _chosen(board: Leaderboard, metrics: Sequence[str] | None) -> list[Record]:
    shown = set(choose(board.metrics, ["all"] if metrics is None else metrics))
    return [record for record in board.records if record.metric in shown]


def _json(board: Leaderboard, metrics: Sequence[str] | None) -> str:
    return as_json(_chosen(board, metrics))


def _csv(board: Leaderboard, metrics: Sequence[str] | None) -> str:
    return as_csv(Record, _chosen(board, metrics))


def _chapters(
    board: Leaderboard, metrics: Sequence[str] | None
) -> Iterator[tuple[str, list[Section]]]:
    """The tables of each track, then those of the price of ignorance."""
    for chapter, tables in groupby(sections(board, metrics), key=lambda s: s.chapter):
        yield chapter, list(tables)


def _markdown(board: Leaderboard, metrics: Sequence[str] | None) -> str:
    blocks = []
    for chapter, tables in _chapters(board, metrics):
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


def _latex(board: Leaderboard, metrics: Sequence[str] | None) -> str:
    lines = ["% needs \\usepackage[T1]{fontenc} and \\usepackage{booktabs}"]
    for chapter, tables in _chapters(board, metrics):
        lines.append(f"\\section*{{{escape.latex(chapter)}}}")
        lines += [line for section in tables for line in _latex_table(section)]
    said = " ".join(escape.latex(line) for line in legend(board))
    return "\n".join([*lines, f"\\noindent {{\\footnotesize {said}}}", ""])


def _latex_table(section: Section) -> list[str]:
    def text(cell: Cell) -> str:
        return f"\\textbf{{{escape.latex(cell.text)}}}" if cell.bold else escape.latex(cell.text)

    def line(parts: Sequence[str]) -> str:
        return f"    {' & '.join(parts)} \\\\"

    caption = " ".join(escape.latex(part) for part in (f"{section.title}.", *section.notes))
    return [
        "\\begin{table}",
        "  \\centering",
        f"  \\caption{{{caption}}}",
        f"  \\begin{{tabular}}{{l{'r' * (len(section.headings) - 1)}}}",
        "    \\toprule",
        line([text(heading) for heading in section.headings]),
        "    \\midrule",
        *(line([text(cell) for cell in row]) for row in section.rows),
        "    \\bottomrule",
        "  \\end{tabular}",
        "\\end{table}",
    ]


_STYLE = (
    "body{font:15px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:75rem;padding:0 1rem;"
    "color-scheme:light dark}table{border-collapse:collapse;font-variant-numeric:tabular-nums}"
    "div{overflow-x:auto}th,td{padding:.25rem .75rem;text-align:right;white-space:nowrap;"
    "border-bottom:1px solid #8884}th:first-child,td:first-child{text-align:left}"
    "h2{margin-top:2.5rem}h3{font-size:1.05rem;margin-top:1.5rem}p{font-size:.9rem}"
)


def _html(board: Leaderboard, metrics: Sequence[str] | None) -> str:
    body = []
    for chapter, tables in _chapters(board, metrics):
        body.append(f"<h2>{escape.html(chapter)}</h2>")
        body += [part for section in tables for part in _html_table(section)]
    said = [f"<p>{escape.html(line)}</p>" for line in legend(board)]
    head = (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width">'
        f"<title>Leaderboard</title><style>{_STYLE}</style></head><body>\n<h1>Leaderboard</h1>"
    )
    return "\n".join([head, *body, *said, "</body></html>", ""])


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


_RENDERERS: dict[str, Callable[[Leaderboard, Sequence[str] | None], str]] = {
    "markdown": _markdown,
    "csv": _csv,
    "latex": _latex,
    "html": _html,
    "json": _json,
}
