"""Read untrusted Parquet files with bounded memory: the decoded size is bounded before decoding.

The sizes in the footer are only a claim. The bound uses the page headers, which the decoder
trusts, and two rules: only the encodings of our writer are allowed, none of which expands few
bytes to many long strings; and repeated strings stay references until their length is known.
"""

from collections.abc import Collection, Iterator
from dataclasses import dataclass

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from benchnav.navigation.command_check import short
from benchnav.store.bounded import page_headers
from benchnav.store.bounded.footer import require_readable
from benchnav.store.bounded.page_headers import Page

FREE = 256 << 20  # [bytes] decoded size that is allowed for any file
RATIO = 64  # allowed decoded size per stored byte, in addition
_MAX_FOOTER = 1 << 20  # [bytes]; a row group takes 9 kB, and a part has one per batch
_MAX_PAGES = 50_000  # of a file; a page holds about 1 MB
_MAX_DICTIONARY = 4 << 20  # [bytes] of a dictionary of strings; our writer's limit is 1 MB
_MAX_IN_LIST = 1_000  # of the footer: row groups, columns
_MAX_TEXT = 1 << 20  # [bytes] of a string in the footer
_WRITER = "parquet-cpp-arrow"
_LEVELS = 4  # [bytes] per list value: its nesting level
_ENCODINGS = {
    page_headers.PLAIN, page_headers.RLE, page_headers.PLAIN_DICTIONARY,
    page_headers.RLE_DICTIONARY,
}  # fmt: skip
_FEW = 1 << 20  # [bytes] of strings, below which the upper bound is precise enough
_MAGIC = b"PAR1"


def allowed(size: int) -> int:
    """Return the allowed decoded size [bytes] of files of ``size`` bytes together."""
    return FREE + RATIO * size


@dataclass(frozen=True)
class _Leaf:
    """A stored column; for a list column, its elements."""

    path: str  # "remarks.list.element"
    width: int  # [bytes] of a decoded value; for a string, of the reference to it
    text: bool = False  # strings that may be stored once and are read as references
    spelled: bool = False  # strings of which each is copied when read


def read(
    content: bytes, schema: pa.Schema, later: Collection[str] = (), encoded: bool = False
) -> pa.Table:
    """Return the table in a file's ``content``.

    Args:
        content: the bytes of the file.
        schema: its columns, in this order.
        later: columns that may be missing.
        encoded: whether texts stay references to distinct texts, which takes less memory.

    Raises ValueError if it is not such a file, or decodes to more than `allowed`.
    """
    length = int.from_bytes(content[-8:-4], "little")
    if len(content) < 12 or content[-4:] != _MAGIC or length > min(_MAX_FOOTER, len(content)):
        raise ValueError("is not a Parquet file, or has a footer that is too large")
    try:
        table, expected = _decode(content, schema, later)
        return table if encoded else table.cast(expected)
    except (pa.ArrowException, OSError, OverflowError) as error:
        raise ValueError(f"cannot be decoded ({short(error)})") from error


def _decode(
    content: bytes, schema: pa.Schema, later: Collection[str]
) -> tuple[pa.Table, pa.Schema]:
    """Return the table with texts as references, and its schema without them."""
    file = _open(content)
    found = file.schema_arrow
    names = set(found.names)
    expected = pa.schema([f for f in schema if f.name in names or f.name not in later])
    _require_columns(found, expected)
    leaves = [leaf for field in expected for leaf in _leaves(field)]
    require_readable(content, file.metadata.schema)
    _require_bound(content, file.metadata, leaves)
    texts = [leaf.path for leaf in leaves if leaf.text]
    table = _open(content, texts, file.metadata).read(use_threads=False)
    spelled = sum(map(_length, table.columns))
    if spelled > allowed(len(content)):
        raise ValueError(f"holds texts of {spelled} bytes, more than {allowed(len(content))}")
    _require_distinct(table)
    return table, expected


def _require_distinct(table: pa.Table) -> None:
    """Raise ValueError if two references may stand for the same text."""
    for name in table.column_names:
        for chunk in table[name].chunks:
            if pa.types.is_dictionary(chunk.type):
                texts = chunk.dictionary
                if texts.null_count or len(texts.unique()) < len(texts):
                    raise ValueError(f"has a dictionary of {name!r} that repeats a text")


def _open(
    content: bytes, texts: Collection[str] = (), metadata: pq.FileMetaData = None
) -> pq.ParquetFile:
    return pq.ParquetFile(
        pa.BufferReader(content), metadata=metadata, read_dictionary=list(texts),
        thrift_string_size_limit=_MAX_TEXT, thrift_container_size_limit=_MAX_IN_LIST,
    )  # fmt: skip


def _require_columns(found: pa.Schema, expected: pa.Schema) -> None:
    if found.names != expected.names:
        missing = [name for name in expected.names if name not in found.names]
        strange = [name for name in found.names if name not in expected.names]
        if missing:
            raise ValueError(f"must have the column {missing[0]!r}; it is missing")
        if strange:
            raise ValueError(f"has an unknown column {strange[0][:60]!r}")
        raise ValueError("has duplicate columns, or columns in another order than a part")
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
    """Raise ValueError if the file decodes to more than `allowed`."""
    if not metadata.created_by.startswith(_WRITER):  # the decoder corrects files of other writers
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
            longest = 0  # [bytes] of the strings that are copied
            for page in page_headers.pages(_chunk(content, column)):
                if leaf.spelled and page.kind == page_headers.DICTIONARY:
                    longest = _longest(page, column.compression)
                size += _size(page, leaf) + page.values * longest
                count += 1
                if size > allowed(len(content)) or count > _MAX_PAGES:
                    raise ValueError(
                        f"holds more than {allowed(len(content))} bytes or {_MAX_PAGES} pages"
                        f" once it is decoded ({len(content)} bytes are stored)"
                    )


def _chunk(content: bytes, column: pq.ColumnChunkMetaData) -> memoryview:
    """Return the bytes of a column in one row group, at the place where the decoder reads them."""
    first, size = column.data_page_offset, column.total_compressed_size
    dictionary = column.dictionary_page_offset
    if column.has_dictionary_page and dictionary is not None and 0 < dictionary < first:
        first = dictionary
    if first < 0 or size < 0 or first + size > len(content):
        raise ValueError("has columns that end beyond the file")
    return memoryview(content)[first : first + size]


def _size(page: Page, leaf: _Leaf) -> int:
    """Return an upper bound [bytes] of the decoded page: its bytes and its values."""
    if page.encoding not in _ENCODINGS:
        raise ValueError(f"has a page in the encoding {page.encoding}, which parts do not use")
    return page.raw + page.values * leaf.width


def _longest(page: Page, compression: str) -> int:
    """Return the length [bytes] of the longest string in a dictionary."""
    if page.raw > _MAX_DICTIONARY:
        raise ValueError(f"has a dictionary of {page.raw} bytes, more than {_MAX_DICTIONARY}")
    body = bytes(page.body)
    if compression != "UNCOMPRESSED":
        body = pa.Codec(compression.lower()).decompress(body, page.raw).to_pybytes()
    at = longest = 0
    while at < len(body):
        length = int.from_bytes(body[at : at + 4], "little")
        longest, at = max(longest, length), at + 4 + length
    return longest


def _length(column: pa.ChunkedArray) -> int:
    """Return about the length [bytes] of a column's strings if each is copied; rarely more."""
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
