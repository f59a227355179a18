"""HTML tables for notebooks, and text that is returned or written to a file."""

from collections.abc import Iterable, Sequence
from html import escape
from os import PathLike
from pathlib import Path

from benchnav.system.plain_file import writing


def written(text: str, path: "str | PathLike[str] | None") -> str:
    """Return the text, and write it to the file ``path`` where one is given.

    Raises StoreError where the file cannot be written.
    """
    if path is not None:
        target = Path(path)
        with writing(target):
            target.write_text(text, encoding="utf-8")
    return text


def key_value_html(title: str, rows: Iterable[tuple[str, str]]) -> str:
    """Return a table of two columns below a title."""
    body = "".join(
        f"<tr><th style='text-align:left'>{escape(key)}</th>"
        f"<td style='text-align:left'>{escape(value)}</td></tr>"
        for key, value in rows
    )
    return f"<p><strong>{escape(title)}</strong></p><table>{body}</table>"


def table_html(title: str, head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table with a head below a title."""
    heads = "".join(f"<th>{escape(text)}</th>" for text in head)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return (
        f"<p><strong>{escape(title)}</strong></p>"
        f"<table><thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table>"
    )
