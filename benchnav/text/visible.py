"""Text from anybody as what is printed: nothing in it acts on a terminal, a page or a table."""

import re
import unicodedata

MARK = "\ufffd"  # stands for a character that is not to be seen
_SURROGATE = "Cs"  # also bytes of file names, which streams write as they are
_LINE_ENDS = ("Zl", "Zp")


class _Marks(dict[int, str]):
    """Code point → what is printed, found once for each that occurs."""

    def __missing__(self, code: int) -> str:
        kind = unicodedata.category(chr(code))
        hidden = (kind.startswith("C") and kind != _SURROGATE) or kind in _LINE_ENDS
        self[code] = MARK if hidden else chr(code)
        return self[code]


_MARKS = _Marks({ord("\n"): "\n", ord("\t"): "\t"})


def visible_lines(text: str) -> str:
    """Return the text with a mark for each character that controls or formats, but line breaks."""
    return text.translate(_MARKS)


def visible(text: str) -> str:
    """Return the same on one line; halves of characters are marked, too."""
    return visible_lines(re.sub(r"\s+", " ", text)).encode("utf-8", "replace").decode()
