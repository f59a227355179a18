"""Frames: the messages in the pipes between a runner and a navigator's process.

frame := kind[8] fields:u64 bytes:u64 field*      bytes: size of all fields together
field := name[24] type[1] axes:u8 zero[6] shape:u64[4] data, padded to 8 bytes

Little-endian; names and kinds are ASCII, padded with zeros. Types: d float64, q int64,
b int8, B uint8, ? bool (a byte, 0 or 1), t text (UTF-8, one axis). Arrays are in C order (rows
first). Every field starts at a multiple of 8. Nothing in a frame is ever executed.
"""

import math
import struct
from collections.abc import Iterable, Mapping
from functools import lru_cache
from mmap import mmap
from typing import Any

import numpy as np

from benchnav.arrays import AnyArray

Field = AnyArray | float | str  # numbers and bools; a value without axes is read as a number
Fields = Mapping[str, Field]

HEAD = struct.Struct("<8sQQ")
MAX_SIZE = 1 << 30  # bytes of a frame
_FIELD = struct.Struct("<24ssB6x4Q")
_TYPES = {kind: np.dtype(kind).newbyteorder("<") for kind in ("d", "q", "b", "B", "?")}
_ITEM = {kind: dtype.itemsize for kind, dtype in _TYPES.items()} | {"t": 1}
_STORED = _TYPES | {"l": _TYPES["q"]}  # numpy has two letters for a type of 64 bits
_SMALL = 1 << 14  # bytes: two copies of so few take less time than a view of the destination

Buffer = bytearray | mmap
Part = tuple[bytes, AnyArray | bytes, int]  # of a field: header, data, bytes of the data
Header = tuple[str, np.dtype[Any] | None, tuple[int, ...], int]  # name, type, shape, bytes


def encode(kind: str, fields: Fields) -> bytearray:
    """Return the bytes of a frame of this kind."""
    parts, size = encode_parts(fields)
    frame = bytearray(HEAD.size + size)
    frame[: HEAD.size] = encode_head(kind, len(fields), size)
    write_parts(parts, frame, HEAD.size)
    return frame


def encode_head(kind: str, count: int, size: int) -> bytes:
    """Return the head of a frame with ``count`` fields of together ``size`` bytes."""
    return HEAD.pack(kind.encode("ascii"), count, size)


def encode_parts(fields: Fields) -> tuple[list[Part], int]:
    """Return (parts, bytes of all parts together) of the fields of a frame."""
    parts = [_encode_field(name, value) for name, value in fields.items()]
    return parts, sum(_FIELD.size + size + -size % 8 for _, _, size in parts)


def write_parts(parts: Iterable[Part], buffer: Buffer, at: int) -> None:
    """Write the parts into ``buffer``, from the byte ``at`` on."""
    for header, data, size in parts:
        start = at + _FIELD.size
        end = start + size
        buffer[at:start] = header
        if isinstance(data, bytes):
            buffer[start:end] = data
        else:
            np.ndarray(data.shape, _STORED[data.dtype.char], buffer, start)[...] = data
        at = end + -size % 8
        if at > end:
            buffer[end:at] = bytes(at - end)


def head(data: bytes | bytearray) -> tuple[str, int, int]:
    """Read the first `HEAD.size` bytes of a frame: (kind, number of fields, bytes that follow).

    Raises ValueError if they are not the head of a frame.
    """
    kind, count, size = HEAD.unpack_from(data)
    if not kind.rstrip(b"\0").isalpha() or size > MAX_SIZE or count * _FIELD.size > size:
        raise ValueError(f"no frame begins with {bytes(data[: HEAD.size])!r}")
    return kind.rstrip(b"\0").decode("ascii"), count, size


def decode(count: int, body: bytearray) -> dict[str, Any]:
    """Return the fields of a frame; arrays are views into ``body``.

    Raises ValueError if ``body`` is not the content of a frame.
    """
    fields: dict[str, Any] = {}
    at = 0
    for _ in range(count):
        start = at + _FIELD.size
        if start > len(body):
            raise ValueError("a frame ends within a field")
        name, dtype, shape, size = _decode_header(bytes(body[at:start]))
        if size > len(body) - start:
            raise ValueError(f"the field {name!r} is longer than its frame")
        if dtype is None:
            fields[name] = body[start : start + size].decode("utf-8")
        else:
            array: AnyArray = np.ndarray(shape, dtype, body, start)
            fields[name] = array if shape else array.item()
        at = start + size + -size % 8
    return fields


def _encode_field(name: str, value: Field) -> Part:
    if isinstance(value, str):
        text = value.encode("utf-8")
        return _encode_header(name, "t", (len(text),)), text, len(text)
    array = np.asarray(value)
    kind = array.dtype.char if array.dtype.char != "l" else "q"
    header = _encode_header(name, kind, array.shape)
    size = array.size * _ITEM[kind]
    if size <= _SMALL and array.dtype == _TYPES[kind]:
        return header, array.tobytes(), size
    return header, array, size


@lru_cache(maxsize=1024)
def _encode_header(name: str, kind: str, shape: tuple[int, ...]) -> bytes:
    if len(name) > 24 or len(shape) > 4:
        raise ValueError(f"The field {name!r} must have at most 24 letters and 4 axes.")
    if kind not in _ITEM:
        raise ValueError(f"The field {name!r} has the type {kind!r}, which no frame holds.")
    padded = [*shape, 0, 0, 0, 0][:4]
    return _FIELD.pack(name.encode("ascii"), kind.encode(), len(shape), *padded)


@lru_cache(maxsize=1024)
def _decode_header(header: bytes) -> Header:
    """Read the header of a field; the type is None for text. Raises ValueError if it is invalid."""
    raw, code, axes, *shape = _FIELD.unpack(header)
    name, kind = raw.rstrip(b"\0").decode("ascii"), code.decode("latin-1")
    if kind not in _ITEM or axes > 4:
        raise ValueError(f"the field {name!r} has type {kind!r} and {axes} axes")
    lengths = tuple(shape[:axes])
    if max(lengths, default=0) > MAX_SIZE:
        raise ValueError(f"the field {name!r} is longer than its frame")
    return name, _TYPES.get(kind), lengths, math.prod(lengths) * _ITEM[kind]
