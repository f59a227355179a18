"""World ↔ JSON, exact for floats.

Every dataclass becomes an object of its fields, every array ``[dtype, shape,
values]`` in C order, every enum its number. A float is written with the fewest
digits that read back to the same bits, so a round trip changes nothing.
"""

from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np
from pydantic_core import SchemaSerializer, SchemaValidator, ValidationError
from pydantic_core.core_schema import (
    CoreConfig,
    CoreSchema,
    DataclassField,
    bool_schema,
    dataclass_args_schema,
    dataclass_field,
    dataclass_schema,
    enum_schema,
    float_schema,
    int_schema,
    no_info_plain_validator_function,
    nullable_schema,
    plain_serializer_function_ser_schema,
    str_schema,
    tuple_schema,
    with_default_schema,
)

from benchnav.arena.agent_bodies import PLAIN_BODY, AgentBodies
from benchnav.arena.agents import Agents
from benchnav.arena.body import Body
from benchnav.arena.sensing import RaySensor
from benchnav.arena.world import World
from benchnav.arrays import AnyArray
from benchnav.config.model_errors import first_problem

_DTYPES = {name: np.dtype(name) for name in ("<f8", "<i8", "|i1", "|b1")}
_PLAIN: dict[type, CoreSchema] = {
    bool: bool_schema(strict=True),
    int: int_schema(strict=True),
    float: float_schema(strict=True),
    str: str_schema(strict=True),
}  # types of JSON itself
_LEFT_OUT: dict[type, dict[str, Any]] = {
    Agents: dict.fromkeys(PLAIN_BODY),
    Body: {"person": False},
    RaySensor: {"circumscribed": False},
}  # fields that may be missing, and their defaults
MAX_TEXT = 64 << 20  # characters of a world; one of a million triangles takes 50 MB
_MAX_CONTAINERS = 1_000_000  # lists and objects in it; an array is one list of values


def world_to_json(world: World) -> bytes:
    """Return the world as one line of JSON in UTF-8 (infinities as in Python: ``Infinity``)."""
    left_out: dict[str, Any] = {
        "agents": world.agents.left_out(),
        "bodies": {n: body.left_out() for n, body in enumerate(world.bodies)},
    }
    if world.sensing.rays is not None:
        left_out["sensing"] = {"rays": world.sensing.rays.left_out()}
    return to_json(World, world, left_out)


def world_from_json(text: str) -> World:
    """Return the world in a text of `world_to_json`.

    Raises:
        TypeError, ValueError: the text is not an encoded world.
    """
    if len(text) > MAX_TEXT or text.count("[") + text.count("{") > _MAX_CONTAINERS:
        raise ValueError(f"a world must have at most {MAX_TEXT} characters; it has {len(text)}")
    world: World = from_json(World, text)
    agents = world.agents
    if any(len(getattr(agents, f.name)) != len(agents) for f in fields(agents)):
        raise ValueError("the arrays of a world's agents must have equal lengths")
    return world


def to_json(kind: Any, value: Any, exclude: Any = None) -> bytes:
    """Return JSON of a value of type ``kind``: a dataclass, array, enum, tuple or number.

    ``exclude`` names the fields that are left out, as pydantic does: {field: {field of its value}}.
    Raises TypeError if this type cannot be encoded.
    """
    return _codec(kind)[0].to_json(value, exclude=exclude, warnings=False, fallback=_encoded)


def from_json(kind: Any, text: str | bytes) -> Any:
    """Return the value of type ``kind`` that `to_json` turned into ``text``.

    Raises:
        TypeError, ValueError: ``text`` is not of this type, or this type cannot be encoded.
    """
    try:
        return _codec(kind)[1].validate_json(text)
    except ValidationError as error:
        problem = first_problem(error)
        where = problem.key or "its text"
        raise ValueError(f"{where} {problem.requirement}; got {problem.got}") from None


@cache
def _codec(kind: Any) -> tuple[SchemaSerializer, SchemaValidator]:
    schema = _schema(kind)
    infinities = CoreConfig(ser_json_inf_nan="constants")
    return SchemaSerializer(schema, infinities), SchemaValidator(schema)


def _schema(kind: Any) -> CoreSchema:
    """Return the description of a type for pydantic's core, which reads and writes JSON."""
    kind = _unalias(kind)
    origin = get_origin(kind) or kind
    if origin is np.ndarray:
        return _ARRAY
    if origin in (Union, UnionType):
        (kind,) = (option for option in get_args(kind) if option is not NoneType)
        return nullable_schema(_schema(kind))
    if origin is tuple:
        return _tuple_schema(get_args(kind))
    if isinstance(kind, type) and is_dataclass(kind):
        names, hints = [f.name for f in fields(kind)], get_type_hints(kind)
        known = [_field_schema(kind, name, hints[name]) for name in names]
        arguments = dataclass_args_schema(kind.__name__, known)
        return dataclass_schema(kind, arguments, names, post_init=issubclass(kind, AgentBodies))
    if isinstance(kind, type) and issubclass(kind, Enum):
        return enum_schema(kind, list(kind), sub_type="int")
    if kind in _PLAIN:
        return _PLAIN[kind]
    raise TypeError(f"a world must not hold values of type {kind}")


def _field_schema(kind: type, name: str, hint: Any) -> DataclassField:
    """Return the description of a field; one that is left out at its default may be missing."""
    schema = _schema(hint)
    if name in _LEFT_OUT.get(kind, {}):
        schema = with_default_schema(schema, default=_LEFT_OUT[kind][name])
    return dataclass_field(name, schema)


def _unalias(kind: Any) -> Any:
    """Return the type behind an alias: NDArray is an alias since NumPy 2.5.

    Arguments of the alias are dropped: an encoded array has its own dtype.
    """
    while (origin := get_origin(kind) or kind) and hasattr(origin, "__value__"):
        kind = origin.__value__
    return kind


def _tuple_schema(kinds: tuple[Any, ...]) -> CoreSchema:
    if len(kinds) == 2 and kinds[1] is Ellipsis:
        # a strange text of a million items is one error
        return tuple_schema([_schema(kinds[0])], variadic_item_index=0, fail_fast=True)
    return tuple_schema([_schema(kind) for kind in kinds])


def _encoded(value: Any) -> Any:
    """Return plain values of an array, or of one of its numbers in place of a plain one."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.ravel().tolist()
    return value.item()


def _decoded(value: Any) -> AnyArray:
    try:
        dtype, shape, items = value
        return np.array(items, dtype=_DTYPES[dtype]).reshape(shape)
    except (KeyError, OverflowError, TypeError, ValueError):
        types = ", ".join(_DTYPES)
        raise ValueError(f"must be an array [type, shape, values] of {types}") from None


_ARRAY = no_info_plain_validator_function(
    _decoded, serialization=plain_serializer_function_ser_schema(_encoded)
)
