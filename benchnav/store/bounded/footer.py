"""The footer of a Parquet file: refuses what would end the process of its decoder.

pyarrow checks some fields of a column where no Python exception can be raised, so the process ends
with a message of C++. The same fields are therefore checked before.
"""

from typing import Any

import pyarrow.parquet as pq

from benchnav.store.bounded.compact_protocol import (
    BYTE,
    DOUBLE,
    FALSE,
    INT16,
    INT64,
    LIST,
    STRUCTURE,
    TEXT,
    TRUE,
    field_head,
    integer,
    unsigned,
)

_GROUPS, _COLUMNS, _COLUMN, _KEYS, _ENCRYPTED, _SIZES = 4, 1, 3, 8, 9, 16  # fields
_CODEC, _CODECS = 4, range(8)  # field of a column, and the values that it may have
_SPELLED, _REPETITIONS, _DEFINITIONS = 1, 2, 3  # fields of the size statistics of a column
_LONG = 15  # length of a list that follows its head
_MAX_DEPTH = 10  # footer, row group, column, statistics, and lists between them


def require_readable(content: bytes, schema: pq.ParquetSchema) -> None:
    """Raise ValueError if a column of the file has fields that do not belong to the schema."""
    length = int.from_bytes(content[-8:-4], "little")
    try:
        footer, _ = _structure(memoryview(content)[-8 - length : -8], 0, _MAX_DEPTH)
        columns = [column for group in footer[_GROUPS] for column in enumerate(group[_COLUMNS])]
        for c, column in columns:
            if _KEYS in column or _ENCRYPTED in column:
                raise ValueError("has an encrypted column")
            if column[_COLUMN][_CODEC] not in _CODECS:
                raise ValueError("has a column with an unknown compression")
            _require_sizes(column[_COLUMN].get(_SIZES) or {}, schema.column(c))
    except (IndexError, KeyError, TypeError, AttributeError) as error:
        raise ValueError("has a footer that cannot be read") from error


def _require_sizes(sizes: dict[int, Any], column: pq.ColumnSchema) -> None:
    """Raise ValueError if size statistics are not those of such a column."""
    if not sizes:
        return
    for field, level in (
        (_REPETITIONS, column.max_repetition_level), (_DEFINITIONS, column.max_definition_level),
    ):  # fmt: skip
        count = len(sizes.get(field) or ())
        if count != level + 1 and not (level == count == 0):
            raise ValueError(f"has size statistics of {count} levels, not {level + 1}")
    if _SPELLED in sizes and column.physical_type != "BYTE_ARRAY":
        raise ValueError("has size statistics of strings for numbers")


def _structure(data: memoryview, at: int, deep: int) -> tuple[dict[int, Any], int]:
    """Return the fields of a structure in Thrift's compact protocol, and its end."""
    fields: dict[int, Any] = {}
    name = 0
    while data[at]:
        name, kind, at = field_head(data, at, name)
        if kind in (TRUE, FALSE):
            fields[name] = kind == TRUE
        else:
            fields[name], at = _value(data, at, kind, deep)
    return fields, at + 1


def _value(data: memoryview, at: int, kind: int, deep: int) -> tuple[Any, int]:
    """Return a value, None if it is not needed, and its end; ``deep``: nestings left."""
    if not deep:
        raise ValueError("has a footer that is nested too deep")
    if kind == STRUCTURE:
        return _structure(data, at, deep - 1)
    if kind == LIST:
        return _list(data, at, deep - 1)
    if kind in (TRUE, FALSE, BYTE):  # in a list, a truth value takes a byte
        return None, at + 1
    if kind == DOUBLE:
        return None, at + 8
    if kind == TEXT:
        length, at = unsigned(data, at)
        return None, at + length
    if not INT16 <= kind <= INT64:
        raise ValueError("has a footer with fields that no footer has")
    return integer(data, at)


def _list(data: memoryview, at: int, deep: int) -> tuple[list[Any], int]:
    head = data[at]
    count, kind, at = head >> 4, head & 15, at + 1
    if count == _LONG:
        count, at = unsigned(data, at)
    values = []
    for _ in range(count):
        value, at = _value(data, at, kind, deep)
        values.append(value)
    return values, at
