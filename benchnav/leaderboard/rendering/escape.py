"""Escape names from plugins and files, so that they are never markup or formulas."""

import re
from html import escape

from benchnav.text.visible import visible

_FORMULA = tuple("=+-@＝＋－＠")  # ASCII and full-width characters


def markdown(text: str) -> str:
    """Return text that a Markdown table cell shows literally."""
    safe = visible(text).replace("&", "&amp;").replace("\\", "\\\\")
    safe = re.sub(r"<(?![\d+−])", "&lt;", safe)  # < before a number begins no tag
    safe = re.sub(r"([|*`~!])", r"\\\1", safe)
    safe = re.sub(r"(?<![^\W_])_|_(?![^\W_])", r"\\_", safe)  # _ within a word is literal
    return re.sub(r"\](?=[(\[:])", r"\\]", safe)


def html(text: str) -> str:
    """Return text that a browser shows literally, in an element or an attribute."""
    return escape(visible(text), quote=True)


def spreadsheet(text: str) -> str:
    """Return text on one line that a spreadsheet does not read as a formula."""
    shown = visible(text)
    return f"'{shown}" if shown.lstrip().startswith(_FORMULA) else shown
