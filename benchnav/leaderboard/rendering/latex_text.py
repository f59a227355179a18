"""Convert text to LaTeX that needs no package, and estimate its width.

The result is ASCII, so it is independent of the LaTeX engine and of its input encoding.
"""

import re
import unicodedata

from benchnav.text.visible import visible

_ASCII = {
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_",
    "{": r"\{", "}": r"\}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}",
    "<": r"\textless{}", ">": r"\textgreater{}", "|": r"\textbar{}", "[": "{[}", "]": "{]}",
    '"': "{''}", "`": "{`}", "'": "{'}",
}  # fmt: skip
_SYMBOLS = {
    "–": "{--}", "—": "{---}", "‐": "-", "‑": "-", "‘": "{`}", "’": "{'}", "“": "{``}", "”": "{''}",
    "…": r"\ldots{}", "•": r"$\bullet$", "·": r"$\cdot$", "°": r"$^\circ$", "′": r"$'$",
    "″": r"$''$", "µ": r"$\mu$", "−": "$-$", "±": r"$\pm$", "×": r"$\times$", "÷": r"$\div$",
    "≤": r"$\leq$", "≥": r"$\geq$", "≠": r"$\neq$", "≈": r"$\approx$", "≡": r"$\equiv$",
    "∼": r"$\sim$", "∝": r"$\propto$", "∞": r"$\infty$", "√": r"$\surd$", "∑": r"$\Sigma$",
    "∏": r"$\Pi$", "∂": r"$\partial$", "∇": r"$\nabla$", "∆": r"$\Delta$", "∈": r"$\in$",
    "∅": r"$\emptyset$", "∩": r"$\cap$", "∪": r"$\cup$", "⊂": r"$\subset$", "¬": r"$\neg$",
    "∧": r"$\wedge$", "∨": r"$\vee$", "→": r"$\rightarrow$", "←": r"$\leftarrow$",
    "↑": r"$\uparrow$", "↓": r"$\downarrow$", "↔": r"$\leftrightarrow$", "⇒": r"$\Rightarrow$",
    "⇐": r"$\Leftarrow$", "⇔": r"$\Leftrightarrow$", "«": r"$\ll$", "»": r"$\gg$",
    "ß": r"\ss{}", "ø": r"\o{}", "Ø": r"\O{}", "æ": r"\ae{}", "Æ": r"\AE{}", "œ": r"\oe{}",
    "Œ": r"\OE{}", "ł": r"\l{}", "Ł": r"\L{}", "ı": r"\i{}", "§": r"\S{}", "¶": r"\P{}",
    "£": r"\pounds{}", "©": r"\copyright{}", "¡": "{!`}", "¿": "{?`}", "⁄": "/",
    "ς": r"$\varsigma$",
}  # fmt: skip
_ACCENTS = {  # combining character → command
    "\u0300": "`", "\u0301": "'", "\u0302": "^", "\u0303": "~", "\u0304": "=", "\u0306": "u",
    "\u0307": ".", "\u0308": '"', "\u030a": "r", "\u030b": "H", "\u030c": "v", "\u0323": "d",
    "\u0327": "c", "\u0331": "b",
}  # fmt: skip
_GREEK = {"LAMDA": "lambda", "OMICRON": "o"}
_GREEK_CAPITALS = {
    "GAMMA", "DELTA", "THETA", "LAMBDA", "XI", "PI", "SIGMA", "UPSILON", "PHI", "PSI", "OMEGA",
}  # fmt: skip
_AS_LATIN = dict(zip("ΑΒΕΖΗΙΚΜΝΟΡΤΧ", "ABEZHIKMNOPTX", strict=True))
_GREEK_LETTER = re.compile(r"GREEK (SMALL|CAPITAL) LETTER ([A-Z]+)")
_WIDTHS = {  # [em] of Computer Modern at 8 pt, rounded up
    0.3: "!',.:;[]`il|\"", 0.36: "fj- ", 0.42: "()rst_", 0.48: "cez",
    0.54: "$*/?0123456789agoJ\\^{}~", 0.6: "kqvxySbdhnpu", 0.74: "LZFEP",
    0.84: "ABCDGHIKNOQRTUVXYw&+=@<>", 0.98: "#%mM", 1.1: "W",
}  # fmt: skip
_WIDTH = {c: width for width, characters in _WIDTHS.items() for c in characters}
_RUN = 10.0  # [em] of text without a break, after which a break is allowed
_BREAKS = frozenset("-/+.:,=_")
_COMMAND = re.compile(r"\\[A-Za-z]+(\{\})?|\\.")


def latex(text: str) -> str:
    """Return text that LaTeX prints literally; an unknown character is shown as ``[U+4E2D]``."""
    plain = re.sub("-(?=-)", "-\0", unicodedata.normalize("NFC", visible(text)))
    return "".join("{}" if c == "\0" else _character(c) for c in plain)  # {} prevents dashes


def breakable(text: str) -> str:
    """Return the same with line breaks allowed after punctuation and within very long words."""
    plain = visible(text)
    pieces, run = [""], 0.0
    for c, following in zip(plain, plain[1:] + " ", strict=False):
        if run > _RUN:
            pieces.append("")
            run = 0.0
        pieces[-1] += c
        run = 0.0 if c == " " else run + width(c)
        if c in _BREAKS and following != " " and not following.isdigit():
            pieces.append("")
            run = 0.0
    return r"\allowbreak{}".join(map(latex, filter(None, pieces)))


def width(text: str) -> float:
    """Return an upper estimate of the width of a text [em]."""
    return sum(map(_width, unicodedata.normalize("NFC", visible(text))))


def _width(c: str) -> float:
    if c.isascii():
        return _WIDTH.get(c, 0.6)
    shown = _COMMAND.sub("x", _character(c))
    return max(1.1, sum(_WIDTH.get(part, 0.85) for part in shown if part not in "{}$"))


def _character(c: str) -> str:
    if c.isascii():
        return _ASCII.get(c, c)
    return _SYMBOLS.get(c) or _letter(c) or f"{{[}}U+{ord(c):04X}{{]}}"


def _letter(c: str) -> str:
    """Return a Greek letter, an accented letter, or a compatibility character; else ""."""
    if c in _AS_LATIN:
        return _AS_LATIN[c]
    greek = _GREEK_LETTER.fullmatch(unicodedata.name(c, ""))
    if greek:
        name = _GREEK.get(greek[2], greek[2].lower())
        known = greek[1] == "SMALL" or name.upper() in _GREEK_CAPITALS
        return f"${name if name == 'o' else _macro(name, greek[1])}$" if known else ""
    kind, *parts = unicodedata.decomposition(c).split() or [""]
    if not kind.startswith("<"):
        return _accented(kind, parts)
    inner = "".join(chr(int(part, 16)) for part in parts)
    if not all(part.isascii() or part in _SYMBOLS or part in _AS_LATIN for part in inner):
        return ""
    shown = "".join(map(_character, inner))
    raised = {"<super>": "^", "<sub>": "_"}.get(kind)
    return f"${raised}{{\\mathrm{{{shown}}}}}$" if raised else shown


def _macro(name: str, case: str) -> str:
    return f"\\{name if case == 'SMALL' else name.capitalize()}"


def _accented(base: str, marks: list[str]) -> str:
    """Return a Latin letter with one accent; "" for anything else."""
    if len(marks) != 1 or chr(int(marks[0], 16)) not in _ACCENTS:
        return ""
    letter = chr(int(base, 16))
    if not (letter.isascii() and letter.isalpha()):
        return ""
    dotless = f"\\{letter}" if letter in "ij" and marks[0] not in ("0323", "0327") else letter
    return f"\\{_ACCENTS[chr(int(marks[0], 16))]}{{{dotless}}}"
