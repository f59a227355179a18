"""LaTeX tables that fit the text width of an article, for any content."""

import re
from collections import Counter
from collections.abc import Iterator, Sequence

from benchnav.leaderboard.rendering.cell import Cell
from benchnav.leaderboard.rendering.latex_text import breakable, latex, width
from benchnav.leaderboard.rendering.section import Section

HEAD = (
    "% Needs \\usepackage{booktabs} and nothing else; made for any engine, in ASCII.",
    "% Every table fits into 345 pt, \\textwidth of the class article.",
)
TEXT_WIDTH = 345.0  # [pt]
SIZE = 8.0  # [pt] of \footnotesize, the size of cells
HEAD_SIZE = 7.7  # [pt] effective size of \scriptsize, for letter widths at 8 pt
BOLD = 1.15  # width of bold text relative to normal text
GAP = 6.0  # [pt] between columns, twice \tabcolsep
WIDEST = 120.0  # [pt] of a column; wider text is broken into lines
HEADING = 14  # largest number of characters on a line of a heading
FLOATS = 12  # tables between page breaks: LaTeX can hold only few floats without a place


def latex_document(tables: Sequence[Section], legend: Sequence[str]) -> str:
    """Return the tables in sequence, and the legend below them; ends with a line break."""
    lines, labels, shown = list(HEAD), Counter[str](), 0
    for section in tables:
        parts = list(_parts(section))
        for k, columns in enumerate(parts):
            part = f", part {k + 1} of {len(parts)}" if len(parts) > 1 else ""
            lines += ["", *_table(section, columns, part, _label(section, k, labels))]
            shown += 1
            if shown % FLOATS == 0:
                lines.append("\\clearpage")
    text = " ".join(map(breakable, legend))
    return "\n".join([*lines, "", f"{{\\footnotesize\\raggedright\\noindent {text}\\par}}", ""])


def _parts(section: Section) -> Iterator[list[int]]:
    """Yield groups of columns that fit side by side; the first column is in every group."""
    widths = [min(_column_width(section, c), WIDEST) for c in range(len(section.headings))]
    part, used = [0], widths[0]
    for c in range(1, len(widths)):
        if used + GAP + widths[c] > TEXT_WIDTH and len(part) > 1:
            yield part
            part, used = [0], widths[0]
        part.append(c)
        used += GAP + widths[c]
    yield part


def _column_width(section: Section, column: int) -> float:
    """Return the width of a column [pt]."""
    heads = [HEAD_SIZE * width(line) for line in _heading_lines(section.headings[column].text)]
    cells = [row[column] for row in section.rows]
    return max([*heads, *(SIZE * width(c.text) * (BOLD if c.bold else 1.0) for c in cells)])


def _heading_lines(text: str) -> list[str]:
    """Return the lines of a heading, broken after punctuation so that its column stays narrow."""
    lines = [""]
    for piece in re.findall(rf"@?[^-/+:,=@ ]{{1,{HEADING}}}[-/+:,=]?|[-/+:,=@ ]", text):
        if lines[-1] and (len(lines[-1] + piece) > HEADING or lines[-1][-1] in "/:,"):
            lines.append("")
        lines[-1] += piece
    return lines


def _table(section: Section, columns: Sequence[int], part: str, label: str) -> list[str]:
    wide = [_column_width(section, c) > WIDEST for c in columns]
    kinds = "".join(_kind(k, broken) for k, broken in enumerate(wide))
    rows = [
        _line(_cell(row[c], broken) for c, broken in zip(columns, wide, strict=True))
        for row in section.rows
    ]
    notes = " ".join(map(breakable, section.notes))
    below = [f"  \\par\\smallskip\\raggedright {notes}\\par"] if notes else []
    return [
        "\\begin{table}[htbp]",
        "  \\centering",
        f"  \\caption{{{breakable(section.title + part)}.}}",
        f"  \\label{{{label}}}",
        "  \\smallskip",
        "  \\footnotesize",
        f"  \\setlength{{\\tabcolsep}}{{{GAP / 2:g}pt}}",
        f"  \\begin{{tabular}}{{@{{}}{kinds}@{{}}}}",
        "    \\toprule",
        _line(_heading(section.headings[c].text, c == 0) for c in columns),
        "    \\midrule",
        *rows,
        "    \\bottomrule",
        "  \\end{tabular}",
        *below,
        "\\end{table}",
    ]


def _kind(place: int, broken: bool) -> str:
    if broken:
        return f"p{{{WIDEST:g}pt}}"
    return "r" if place else "l"


def _line(parts: Iterator[str]) -> str:
    return f"    {' & '.join(parts)} \\tabularnewline"  # unlike \\, works after \raggedright


def _cell(part: Cell, broken: bool) -> str:
    text = f"\\raggedright {breakable(part.text)}" if broken else latex(part.text)
    return f"\\textbf{{{text}}}" if part.bold else text


def _heading(text: str, first: bool) -> str:
    lines = [f"\\scriptsize {latex(line)}" for line in _heading_lines(text)]
    if len(lines) < 2:
        return lines[0]
    side = "l" if first else "r"
    inner = r" \\ ".join(lines)
    return f"\\begin{{tabular}}[b]{{@{{}}{side}@{{}}}}{inner}\\end{{tabular}}"


def _label(section: Section, part: int, labels: Counter[str]) -> str:
    """Return a label of letters, digits and hyphens that no other table has."""
    plain = (re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-") for text in section.name)
    label = "tab:" + "-".join(filter(None, plain)) + (f"-{part + 1}" if part else "")
    labels[label] += 1
    return label if labels[label] == 1 else f"{label}-again-{labels[label]}"
