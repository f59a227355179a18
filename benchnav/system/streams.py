"""Standard streams that a code page, a full disk or a closed pipe never turns into a traceback."""

import codecs
import io
import os
import sys
import unicodedata
from typing import TextIO

_PLAIN = "benchnav.plain"  # error handler: replaces characters that a code page does not have
_ASCII = "benchnav_ascii"  # ASCII under another name: typer overrides streams named "ascii"
_REPLACEMENTS = {
    "–": "-", "—": "-", "−": "-", "×": "x", "µ": "u", "μ": "u", "·": ".", "…": "...", "±": "+-",
    "↑": "^", "↓": "v", "→": "->", "←": "<-", "≤": "<=", "≥": ">=", "≈": "~", "√": "sqrt",
    "‘": "'", "’": "'", "“": '"', "”": '"', "•": "*", "σ": "sigma", "α": "alpha", "π": "pi",
}  # fmt: skip


class _MessageStream(io.TextIOWrapper):
    """A stream of messages; it drops text that cannot be written, as the work must continue."""

    def __init__(self, over: io.TextIOWrapper) -> None:
        super().__init__(over.buffer, _encoding(over), errors=_PLAIN, line_buffering=True)
        self._over = over  # a reference, because its finalizer would close the file

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
    """Open closed streams, let stderr ignore write errors, and make all text encodable."""
    while (file := os.open(os.devnull, os.O_RDWR)) <= 2:  # else the next file opened is stdout
        pass
    os.close(file)
    codecs.register_error(_PLAIN, _replace)
    codecs.register(_ascii)
    sys.stdout = _or_null(sys.stdout, 1)
    sys.stderr = message_stream(_or_null(sys.stderr, 2))
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(encoding=_encoding(sys.stdout), errors=_PLAIN)


def message_stream(stream: TextIO) -> TextIO:
    """Return a message stream that writes to the same file as ``stream``."""
    return _MessageStream(stream) if isinstance(stream, io.TextIOWrapper) else stream


def drop(stream: TextIO) -> None:
    """Discard the buffered text of ``stream``, and all text written from now on."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, stream.fileno())
    os.close(null)


def _or_null(stream: TextIO | None, file: int) -> TextIO:
    """Return ``stream``; if it was closed, a stream over ``file``, now the null device."""
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


def _replace(error: UnicodeError) -> tuple[str | bytes, int]:
    """Replace a character that the code page does not have; keep bytes of file names."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    character = error.object[error.start]
    if 0xDC80 <= ord(character) <= 0xDCFF:  # a byte of a file name, as Python decodes it
        return bytes([ord(character) - 0xDC00]), error.start + 1
    plain = unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode()
    return _REPLACEMENTS.get(character) or plain or f"\\u{ord(character):04x}", error.start + 1
