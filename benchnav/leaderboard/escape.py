"""Names come from plugins and files: nothing in them may act in what is printed."""

import re
import unicodedata
from html import escape


def visible(text: str) -> str:
    """Line breaks become spaces, control and formatting characters a replacement mark."""
    spaced = re.sub(r"\s+", " ", text)
    return "".join("\ufffd" if unicodedata.category(c).startswith("C") else c for c in spaced)


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
    """Text that a spreadsheet does not take for a formula."""
    return f"'{text}" if text[:1] in ("=", "+", "-", "@", "\t", "\r") else text
