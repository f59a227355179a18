"""Thrift's compact protocol, in which Parquet stores its footer and page headers: its values.

Specification: thrift/doc/specs/thrift-compact-protocol.md of Apache Thrift.
"""

TRUE, FALSE, BYTE, INT16, INT32, INT64, DOUBLE, TEXT, LIST = range(1, 10)  # kinds of fields
STRUCTURE = 12
_MAX_INTEGER = 10  # bytes of an integer


def field_head(data: memoryview, at: int, before: int) -> tuple[int, int, int]:
    """Return number and kind of a field, and the end of its head.

    Args:
        data: the structure.
        at: where the field begins.
        before: number of the field before it, else 0.
    """
    kind, delta = data[at] & 15, data[at] >> 4
    if delta:
        return before + delta, kind, at + 1
    number, at = integer(data, at + 1)
    return number, kind, at


def integer(data: memoryview, at: int) -> tuple[int, int]:
    """Return a signed integer, and its end."""
    value, at = unsigned(data, at)
    return (value >> 1) ^ -(value & 1), at


def unsigned(data: memoryview, at: int) -> tuple[int, int]:
    """Return an unsigned integer, and its end. Raises ValueError if it is too long."""
    byte = data[at]
    if byte < 128:
        return byte, at + 1
    value = byte & 127
    for k in range(1, _MAX_INTEGER):
        byte = data[at + k]
        value |= (byte & 127) << 7 * k
        if byte < 128:
            return value, at + k + 1
    raise ValueError("an integer in its headers is too long")
