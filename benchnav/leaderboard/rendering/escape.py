"""Names come from plugins and files: nothing in them may act in what is printed."""

import re
from html import escape

from benchnav.text.visible import visible

_FORMULA = tuple("=+-@＝＋－＠")  # also in full width


def markdown(text: str) -> str:
    """Text that a Markdown table cell shows as it is."""
    safe = visible(text).replace("&", "&amp;").replace("\\", "\\\\")
    safe = re.sub(r"<(?![\d+−])", "&lt;", safe)  # before a number it begins no tag
    safe = re.sub(r"([|*`~!])", r"\\\1", safe)
    safe = re.sub(r"(?<![^\W_])_|_(?![^\W_])", r"\\_", safe)  # within a word it does nothing
    return re.sub(r"\](?=[(\[:])", r"\\]", safe)


def html(text: str) -> str:
    """Text that a browser shows as it is, in an element or an attribute."""
    return escape(visible(text), quote=True)


def spreadsheet(text: str) -> str:
    """Text on one line that a spreadsheet does not take for a formula."""
    shown = visible(text)
    return f"'{shown}" if shown.lstrip().startswith(_FORMULA) else shown
