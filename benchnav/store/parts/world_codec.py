"""World ↔ plain JSON values, exact for floats.

Every dataclass becomes an object of its fields, every array ``[dtype, shape,
values]`` in C order, every enum its number. Python writes a float with the fewest
digits that read back to the same bits, so a round trip changes nothing.
"""

import json
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache
from operator import attrgetter
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np

from benchnav.arena.world import World
from benchnav.arrays import AnyArray
from benchnav.config.document import shown

_DTYPES = {name: np.dtype(name) for name in ("<f8", "<i8", "|i1", "|b1")}
Convert = Callable[[Any], Any]
_PLAIN = {bool: (bool,), int: (int,), float: (int, float), str: (str,)}  # types of JSON itself
MAX_TEXT = 64 << 20  # characters of a world; one of a million triangles takes 50 MB
_MAX_CONTAINERS = 1_000_000  # lists and objects in it; an array is one list of values


def world_to_json(world: World) -> str:
    """Return the world as one line of JSON (infinities as in Python: ``Infinity``)."""
    return json.dumps(encode(world), separators=(",", ":"))


def world_from_json(text: str) -> World:
    """Return the world in a text of `world_to_json`.

    Raises:
        KeyError, TypeError, ValueError: the text is not an encoded world.
    """
    if len(text) > MAX_TEXT or text.count("[") + text.count("{") > _MAX_CONTAINERS:
        raise ValueError(f"a world must have at most {MAX_TEXT} characters; it has {len(text)}")
    world: World = decode(World, json.loads(text))
    agents = world.agents
    if any(len(getattr(agents, f.name)) != len(agents) for f in fields(agents)):
        raise ValueError("the arrays of a world's agents must have equal lengths")
    return world


def encode(value: Any) -> Any:
    """Return plain JSON values of a dataclass, array, enum, tuple or number."""
    kind: Any = type(value)
    return _encoder(kind)(value)


def decode(kind: Any, value: Any) -> Any:
    """Return the value of type ``kind`` that `encode` turned into ``value``.

    Raises:
        KeyError, TypeError, ValueError: ``value`` is not of this type, or this type
            cannot be encoded.
    """
    return _decoder(kind)(value)


@cache
def _encoder(kind: type) -> Convert:
    """Return the function that encodes values of a type; a lookup per value takes far longer."""
    if issubclass(kind, np.ndarray):
        return lambda value: [value.dtype.str, list(value.shape), value.ravel().tolist()]
    if is_dataclass(kind):
        return _dataclass_encoder([f.name for f in fields(kind)])
    if issubclass(kind, Enum):
        return lambda value: value.value
    if issubclass(kind, tuple | list):
        return lambda value: [_encoder(item.__class__)(item) for item in value]
    if issubclass(kind, np.generic):
        return lambda value: value.item()
    return lambda value: value


def _dataclass_encoder(names: list[str]) -> Convert:
    values = attrgetter(*names) if len(names) > 1 else lambda value: (getattr(value, names[0]),)

    def encoded(value: Any) -> dict[str, Any]:
        return {
            name: one if one.__class__ in _PLAIN else _encoder(one.__class__)(one)
            for name, one in zip(names, values(value), strict=True)
        }

    return encoded


@cache
def _decoder(kind: Any) -> Convert:
    """Return the function that decodes values of a type."""
    kind = _unalias(kind)
    origin = get_origin(kind) or kind
    if origin is np.ndarray:
        return lambda value: _decode_array(*value)
    if origin in (Union, UnionType):
        (kind,) = (option for option in get_args(kind) if option is not NoneType)
        known = _decoder(kind)
        return lambda value: None if value is None else known(value)
    if origin is tuple:
        return _tuple_decoder(get_args(kind))
    if isinstance(kind, type) and is_dataclass(kind):
        return _dataclass_decoder(kind)
    if isinstance(kind, type) and issubclass(kind, Enum):
        return kind
    if kind in _PLAIN:
        return _plain_decoder(kind)
    raise TypeError(f"a world must not hold values of type {kind}")


def _unalias(kind: Any) -> Any:
    """Return the type behind an alias: NDArray is an alias since NumPy 2.5.

    Arguments of the alias are dropped: an encoded array has its own dtype.
    """
    while (origin := get_origin(kind) or kind) and hasattr(origin, "__value__"):
        kind = origin.__value__
    return kind


def _decode_array(dtype: str, shape: list[int], items: list[Any]) -> AnyArray:
    if dtype not in _DTYPES:
        raise ValueError(f"an array must be of {', '.join(_DTYPES)}; got {str(dtype)[:20]!r}")
    return np.array(items, dtype=_DTYPES[dtype]).reshape(shape)


def _tuple_decoder(kinds: tuple[Any, ...]) -> Convert:
    if len(kinds) == 2 and kinds[1] is Ellipsis:
        each = _decoder(kinds[0])
        return lambda value: tuple([each(item) for item in value])
    items = [_decoder(kind) for kind in kinds]
    return lambda value: tuple([one(item) for one, item in zip(items, value, strict=True)])


def _dataclass_decoder(kind: Any) -> Convert:
    hints = get_type_hints(kind)
    known = [(f.name, _decoder(hints[f.name])) for f in fields(kind)]
    return lambda value: kind(**{name: one(value[name]) for name, one in known})


def _plain_decoder(kind: Any) -> Convert:
    accepted = _PLAIN[kind]

    def decoded(value: Any) -> Any:
        if type(value) not in accepted:
            raise TypeError(f"a value must be of type {kind.__name__}; got {shown(value)}")
        return value

    return decoded
