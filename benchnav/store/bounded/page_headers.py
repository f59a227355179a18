"""The page headers of a Parquet column: the true cost of decoding it.

The footer of a file and the header of a page both give the decompressed size of a page. The
decoder trusts the header, so a bound must use the header.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from benchnav.store.bounded.compact_protocol import (
    BYTE,
    DOUBLE,
    FALSE,
    INT32,
    STRUCTURE,
    TEXT,
    TRUE,
    field_head,
    integer,
    unsigned,
)

DATA, DICTIONARY, DATA_V2 = 0, 2, 3  # kinds of pages
PLAIN, PLAIN_DICTIONARY, RLE, RLE_DICTIONARY = 0, 2, 3, 8  # encodings
_KIND, _RAW, _PACKED = 1, 2, 3  # fields of a header
_OF_KIND = {DATA: (5, 1, 2), DICTIONARY: (7, 1, 2), DATA_V2: (8, 1, 4)}
"""Kind of page → field with its own header, and the fields of count and encoding in it."""
_MAX_DEPTH = 4  # nested structures: page, data page, statistics
_MAX_FIELDS = 64  # of a structure; the decoder reads larger field numbers as other ones
_KINDS = {*range(TRUE, TEXT + 1), STRUCTURE}


@dataclass(frozen=True)
class Page:
    """The header of a page, as the decoder uses it."""

    kind: int
    raw: int  # [bytes] after decompression
    values: int  # number of values, nulls included
    encoding: int
    body: memoryview  # as stored


def pages(chunk: memoryview) -> Iterator[Page]:
    """Yield the pages of a column of one row group, whose bytes are ``chunk``.

    Raises ValueError if these are not pages.
    """
    at = 0
    while at < len(chunk):
        try:
            fields, at = _structure(chunk, at, _MAX_DEPTH)
            kind, raw, packed = fields[_KIND], fields[_RAW], fields[_PACKED]
            own, count, encoding = _OF_KIND[kind]
            values, body = fields[own][count], chunk[at : at + packed]
            page = Page(kind, raw, values, fields[own][encoding], body)
        except (IndexError, KeyError, TypeError) as error:
            raise ValueError("the header of a page cannot be read") from error
        if min(page.raw, packed, page.values) < 0 or at + packed > len(chunk):
            raise ValueError("the header of a page has impossible sizes")
        at += packed
        yield page


def _structure(data: memoryview, at: int, deep: int) -> tuple[dict[int, Any], int]:
    """Return the fields of a structure in Thrift's compact protocol, and its end.

    Only structures and 32-bit integers are returned, as the decoder treats a field of another type
    like an unknown field.
    """
    if not deep:
        raise ValueError("the header of a page is nested too deep")
    fields: dict[int, Any] = {}
    name = 0
    while data[at]:
        name, kind, at = field_head(data, at, name)
        if not 0 < name < _MAX_FIELDS or kind not in _KINDS:
            raise ValueError("the header of a page has a field that no page has")
        if kind == INT32:
            fields[name], at = integer(data, at)
        elif kind == STRUCTURE:
            fields[name], at = _structure(data, at, deep - 1)
        else:
            at = _after(data, at, kind)
    return fields, at + 1


def _after(data: memoryview, at: int, kind: int) -> int:
    """Return the end of a value that is skipped."""
    if kind in (TRUE, FALSE):
        return at
    if kind == BYTE:
        return at + 1
    if kind == DOUBLE:
        return at + 8
    value, at = unsigned(data, at)
    return at + value if kind == TEXT else at
