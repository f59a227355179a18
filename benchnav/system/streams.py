"""Standard streams that no code page, full disk or closed pipe turns into a traceback."""

import codecs
import io
import os
import sys
import unicodedata
from typing import TextIO

_PLAIN = "benchnav.plain"  # error handler: writes what a code page lacks in other characters
_ASCII = "benchnav_ascii"  # ASCII under a name of ours: typer overrules streams that say "ascii"
_SPELLED = {
    "–": "-", "—": "-", "−": "-", "×": "x", "µ": "u", "μ": "u", "·": ".", "…": "...", "±": "+-",
    "↑": "^", "↓": "v", "→": "->", "←": "<-", "≤": "<=", "≥": ">=", "≈": "~", "√": "sqrt",
    "‘": "'", "’": "'", "“": '"', "”": '"', "•": "*", "σ": "sigma", "α": "alpha", "π": "pi",
}  # fmt: skip


class _Talk(io.TextIOWrapper):
    """Messages: what cannot be written is dropped, because the work matters more."""

    def __init__(self, over: io.TextIOWrapper) -> None:
        super().__init__(over.buffer, _encoding(over), errors=_PLAIN, line_buffering=True)
        self._over = over  # kept, because its end would close the file

    def write(self, text: str) -> int:
        try:
            return super().write(text)
        except OSError:
            return len(text)

    def flush(self) -> None:
        try:
            super().flush()
        except OSError:
            drop(self)


def prepare_streams() -> None:
    """Open what is closed, make stderr forgiving, and let every code page carry our text."""
    while (file := os.open(os.devnull, os.O_RDWR)) <= 2:  # else the next file opened is stdout
        pass
    os.close(file)
    codecs.register_error(_PLAIN, _spell)
    codecs.register(_ascii)
    sys.stdout = _or_nothing(sys.stdout, 1)
    sys.stderr = talk(_or_nothing(sys.stderr, 2))
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(encoding=_encoding(sys.stdout), errors=_PLAIN)


def talk(stream: TextIO) -> TextIO:
    """Return a stream of messages that goes where ``stream`` goes."""
    return _Talk(stream) if isinstance(stream, io.TextIOWrapper) else stream


def drop(stream: TextIO) -> None:
    """Send what is written to ``stream`` from now on, and what it still holds, to nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, stream.fileno())
    os.close(nowhere)


def _or_nothing(stream: TextIO | None, file: int) -> TextIO:
    """``stream``, or where it was closed one over ``file``, which now leads nowhere."""
    return stream or open(file, "w", encoding="utf-8", closefd=False)


def _encoding(stream: TextIO) -> str:
    return _ASCII if codecs.lookup(stream.encoding).name == "ascii" else stream.encoding


def _ascii(name: str) -> codecs.CodecInfo | None:
    if name != _ASCII:
        return None
    known = codecs.lookup("ascii")
    return codecs.CodecInfo(
        known.encode, known.decode, known.streamreader, known.streamwriter,
        known.incrementalencoder, known.incrementaldecoder, _ASCII,
    )  # fmt: skip


def _spell(error: UnicodeError) -> tuple[str | bytes, int]:
    """The characters that a code page lacks, in those that it has; bytes of file names as such."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    character = error.object[error.start]
    if 0xDC80 <= ord(character) <= 0xDCFF:  # a byte of a file's name, as Python reads it
        return bytes([ord(character) - 0xDC00]), error.start + 1
    plain = unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode()
    return _SPELLED.get(character) or plain or f"\\u{ord(character):04x}", error.start + 1
