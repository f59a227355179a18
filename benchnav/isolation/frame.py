"""Frames: the messages in the pipes between a runner and a navigator's process.

frame := kind[8] fields:u64 bytes:u64 field*      bytes: size of all fields together
field := name[24] type[1] axes:u8 zero[6] shape:u64[4] data, padded to 8 bytes

Little-endian; names and kinds are ASCII, padded with zeros. Types: d float64, q int64,
b int8, B uint8, ? bool (a byte, 0 or 1), t text (UTF-8, one axis). Arrays are in C order (rows
first). Every field starts at a multiple of 8. Nothing in a frame is ever executed.
"""

import struct
from collections.abc import Mapping
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


def encode(kind: str, fields: Fields) -> bytes:
    """Return the bytes of a frame of this kind."""
    parts: list[bytes] = []
    for name, value in fields.items():
        parts += _encode_field(name, value)
    body = b"".join(parts)
    return HEAD.pack(kind.encode("ascii"), len(fields), len(body)) + body


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
        if at + _FIELD.size > len(body):
            raise ValueError("a frame ends within a field")
        raw, kind, axes, *shape = _FIELD.unpack_from(body, at)
        name, kind = raw.rstrip(b"\0").decode("ascii"), kind.decode("latin-1")
        if kind not in _ITEM or axes > 4:
            raise ValueError(f"the field {name!r} has type {kind!r} and {axes} axes")
        shape, at = shape[:axes], at + _FIELD.size
        items = 1
        for length in shape:
            items *= length
        size = items * _ITEM[kind]
        if size > len(body) - at:
            raise ValueError(f"the field {name!r} is longer than its frame")
        fields[name] = _decode_field(kind, body, at, items, shape)
        at += size + -size % 8
    return fields


def _encode_field(name: str, value: Field) -> list[bytes]:
    if isinstance(value, str):
        data, kind, shape = value.encode("utf-8"), "t", [len(value.encode("utf-8"))]
    else:
        array = np.asarray(value)
        kind = array.dtype.char if array.dtype.char != "l" else "q"
        data, shape = np.ascontiguousarray(array, _TYPES[kind]).tobytes(), list(array.shape)
    padded = [*shape, 0, 0, 0, 0][:4]
    if len(name) > 24 or len(shape) > 4:
        raise ValueError(f"The field {name!r} must have at most 24 letters and 4 axes.")
    header = _FIELD.pack(name.encode("ascii"), kind.encode(), len(shape), *padded)
    return [header, data, bytes(-len(data) % 8)]


def _decode_field(kind: str, body: bytearray, at: int, items: int, shape: list[int]) -> Any:
    if kind == "t":
        return body[at : at + items].decode("utf-8")
    array = np.frombuffer(body, _TYPES[kind], items, at).reshape(shape)
    return array if shape else array.item()
