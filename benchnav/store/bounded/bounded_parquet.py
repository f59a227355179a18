"""Parquet files from anybody: how much one decodes to is known before any of it is decoded.

What the footer says of sizes is only a claim. A bound follows from the headers of the pages, which
the decoder believes, and from two rules: the encodings are those that our writer uses, none of
which makes many long texts of few bytes, and texts that repeat are kept as references until their
length is known.
"""

from collections.abc import Collection, Iterator
from dataclasses import dataclass

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from benchnav.navigation.command_check import short
from benchnav.store.bounded import page_headers
from benchnav.store.bounded.page_headers import Page

FREE = 256 << 20  # [bytes] that any file may decode to
RATIO = 64  # times its own size that a larger file may decode to, besides
_MOST_FOOTER = 1 << 20  # [bytes]; a row group takes 9 kB, and a part has one for each batch
_MOST_PAGES = 50_000  # of a file; a page holds about 1 MB
_MOST_DICTIONARY = 4 << 20  # [bytes] of texts that are written out; our writer has 1 MB
_MOST_IN_LIST = 1_000  # of the footer: row groups, columns
_MOST_TEXT = 1 << 20  # [bytes] of a text in the footer
_WRITER = "parquet-cpp-arrow"
_LEVELS = 4  # [bytes] for each value of a list: at which depth it stands
_ENCODINGS = {
    page_headers.PLAIN, page_headers.RLE, page_headers.PLAIN_DICTIONARY,
    page_headers.RLE_DICTIONARY,
}  # fmt: skip
_FEW = 1 << 20  # [bytes] of texts, below which the most that they can be is near enough
_MAGIC = b"PAR1"


def allowed(size: int) -> int:
    """Return how many bytes a file, or files together, of ``size`` bytes may decode to."""
    return FREE + RATIO * size


@dataclass(frozen=True)
class _Leaf:
    """A column as it is stored: of a list, its elements."""

    path: str  # "remarks.list.element"
    width: int  # [bytes] of a value once it is decoded; of a text, of the reference to it
    text: bool = False  # of which equal ones may be stored once, and are read as references
    spelled: bool = False  # the same, but each is written out when it is read


def read(content: bytes, schema: pa.Schema, later: Collection[str] = ()) -> pa.Table:
    """Return the table in a file's ``content``.

    Args:
        content: the file.
        schema: its columns, in this order.
        later: columns that it may lack.

    Raises ValueError where it is not such a file, or decodes to more than `allowed`.
    """
    length = int.from_bytes(content[-8:-4], "little")
    if len(content) < 12 or content[-4:] != _MAGIC or length > min(_MOST_FOOTER, len(content)):
        raise ValueError("is no Parquet file, or has a footer that is too large")
    try:
        return _decoded(content, schema, later)
    except (pa.ArrowException, OSError, OverflowError) as error:
        raise ValueError(f"cannot be decoded ({short(error)})") from error


def _decoded(content: bytes, schema: pa.Schema, later: Collection[str]) -> pa.Table:
    file = _opened(content)
    found = file.schema_arrow
    names = set(found.names)
    expected = pa.schema([f for f in schema if f.name in names or f.name not in later])
    _require_columns(found, expected)
    leaves = [leaf for field in expected for leaf in _leaves(field)]
    _require_bound(content, file.metadata, leaves)
    texts = [leaf.path for leaf in leaves if leaf.text]
    table = _opened(content, texts, file.metadata).read(use_threads=False)
    spelled = sum(map(_length, table.columns))
    if spelled > allowed(len(content)):
        raise ValueError(f"holds texts of {spelled} bytes, more than {allowed(len(content))}")
    return table.cast(expected)


def _opened(
    content: bytes, texts: Collection[str] = (), metadata: pq.FileMetaData = None
) -> pq.ParquetFile:
    return pq.ParquetFile(
        pa.BufferReader(content), metadata=metadata, read_dictionary=list(texts),
        thrift_string_size_limit=_MOST_TEXT, thrift_container_size_limit=_MOST_IN_LIST,
    )  # fmt: skip


def _require_columns(found: pa.Schema, expected: pa.Schema) -> None:
    if found.names != expected.names:
        missing = [name for name in expected.names if name not in found.names]
        strange = [name for name in found.names if name not in expected.names]
        if missing:
            raise ValueError(f"must have the column {missing[0]!r}, and has none")
        if strange:
            raise ValueError(f"has a column {strange[0][:60]!r}, which no part has")
        raise ValueError("has its columns twice or in another order than a part")
    for field, other in zip(expected, found, strict=True):
        if field.type != other.type:
            raise ValueError(
                f"must have a column {field.name!r} of {field.type}; it is of"
                f" {str(other.type)[:60]}"
            )


def _leaves(field: pa.Field) -> Iterator[_Leaf]:
    if pa.types.is_list(field.type) or pa.types.is_large_list(field.type):
        (below,) = _leaves(field.type.value_field.with_name("element"))
        path = f"{field.name}.list.{below.path}"
        yield _Leaf(path, below.width + _LEVELS, spelled=below.text)
    elif pa.types.is_large_string(field.type):
        yield _Leaf(field.name, 8, spelled=True)
    elif pa.types.is_string(field.type):
        yield _Leaf(field.name, 4, text=True)
    else:
        yield _Leaf(field.name, max(1, field.type.bit_width // 8))


def _require_bound(content: bytes, metadata: pq.FileMetaData, leaves: list[_Leaf]) -> None:
    """Raise ValueError where the file decodes to more than `allowed`."""
    if not metadata.created_by.startswith(_WRITER):  # else the decoder repairs what others wrote
        raise ValueError(f"must be written by {_WRITER}; got {metadata.created_by[:60]!r}")
    if metadata.num_columns != len(leaves):
        raise ValueError(f"must have {len(leaves)} stored columns; it has {metadata.num_columns}")
    size = count = 0
    for g in range(metadata.num_row_groups):
        group = metadata.row_group(g)
        if group.num_rows < 0:
            raise ValueError(f"must not have a row group of {group.num_rows} rows")
        size += group.num_rows * 8 * len(leaves)
        for c, leaf in enumerate(leaves):
            column = group.column(c)
            if column.path_in_schema != leaf.path:
                raise ValueError(f"must store {leaf.path}; it stores {column.path_in_schema[:60]}")
            longest = 0  # [bytes] of the texts that are written out
            for page in page_headers.pages(_chunk(content, column)):
                if leaf.spelled and page.kind == page_headers.DICTIONARY:
                    longest = _longest(page, column.compression)
                size += _size(page, leaf) + page.values * longest
                count += 1
                if size > allowed(len(content)) or count > _MOST_PAGES:
                    raise ValueError(
                        f"holds more than {allowed(len(content))} bytes or {_MOST_PAGES} pages"
                        f" once it is decoded ({len(content)} bytes are stored)"
                    )


def _chunk(content: bytes, column: pq.ColumnChunkMetaData) -> memoryview:
    """Return the bytes of a column in one row group, where the decoder will look for them."""
    first, size = column.data_page_offset, column.total_compressed_size
    dictionary = column.dictionary_page_offset
    if column.has_dictionary_page and dictionary is not None and 0 < dictionary < first:
        first = dictionary
    if first < 0 or size < 0 or first + size > len(content):
        raise ValueError("has columns that end beyond the file")
    return memoryview(content)[first : first + size]


def _size(page: Page, leaf: _Leaf) -> int:
    """Return how much decoding a page takes at most: its bytes, and its values."""
    if page.encoding not in _ENCODINGS:
        raise ValueError(f"has a page in the encoding {page.encoding}, which no part has")
    return page.raw + page.values * leaf.width


def _longest(page: Page, compression: str) -> int:
    """Return the bytes of the longest text in a dictionary."""
    if page.raw > _MOST_DICTIONARY:
        raise ValueError(f"has a dictionary of {page.raw} bytes, more than {_MOST_DICTIONARY}")
    body = bytes(page.body)
    if compression != "UNCOMPRESSED":
        body = pa.Codec(compression.lower()).decompress(body, page.raw).to_pybytes()
    at = longest = 0
    while at < len(body):
        length = int.from_bytes(body[at : at + 4], "little")
        longest, at = max(longest, length), at + 4 + length
    return longest


def _length(column: pa.ChunkedArray) -> int:
    """Return the bytes of the texts in a column once each is written out, or few more."""
    total = 0
    for chunk in column.chunks:
        if not pa.types.is_dictionary(chunk.type) or not len(chunk.dictionary):
            continue
        if (most := chunk.dictionary.nbytes * len(chunk)) <= _FEW:
            total += most
        else:
            lengths = pc.binary_length(chunk.dictionary).take(chunk.indices)
            total += pc.sum(pc.cast(lengths, pa.int64())).as_py() or 0
    return total
