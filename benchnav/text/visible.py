"""Make untrusted text printable: no character in it acts on a terminal, page or table."""

import re
import unicodedata

MARK = "\ufffd"  # replaces a character that must not be printed
_SURROGATE = "Cs"  # includes bytes of file names, which streams write unchanged
_LINE_ENDS = ("Zl", "Zp")


class _Marks(dict[int, str]):
    """Code point → printed text, computed once per code point."""

    def __missing__(self, code: int) -> str:
        kind = unicodedata.category(chr(code))
        hidden = (kind.startswith("C") and kind != _SURROGATE) or kind in _LINE_ENDS
        self[code] = MARK if hidden else chr(code)
        return self[code]


_MARKS = _Marks({ord("\n"): "\n", ord("\t"): "\t"})


def visible_lines(text: str) -> str:
    """Return the text with `MARK` for control and format characters, except line breaks."""
    return text.translate(_MARKS)


def visible(text: str) -> str:
    """Return the text on one line, with `MARK` for control, format and unpaired characters."""
    return visible_lines(re.sub(r"\s+", " ", text)).encode("utf-8", "replace").decode()


def shortened(text: str, most: int) -> str:
    """Return the text, cut to ``most`` characters, the last three of which are then dots."""
    return text if len(text) <= most else text[: most - 3] + "..."
