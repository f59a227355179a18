"""Check a document against a pydantic model; every error names file, line and key."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from benchnav.config.document import Document, PathKey, shown
from benchnav.config.model_errors import requirement
from benchnav.errors import ScenarioError, did_you_mean

MAX_ERRORS = 10
M = TypeVar("M", bound=BaseModel)
Schema = dict[str, Any]

_OF_TYPE = {  # the value has the wrong type
    "float_type", "int_type", "bool_type", "string_type", "dict_type", "model_type", "list_type",
    "tuple_type", "path_type", "model_attributes_type", "literal_error", "enum", "sampler",
}  # fmt: skip
_LOOK_AHEAD = 4  # ratio of the errors examined for merging to the errors shown


class FieldError(ValueError):
    """An error of a model's own check about the key at ``path`` inside that model."""

    def __init__(self, path: Sequence[PathKey], message: str) -> None:
        super().__init__(message)
        self.path = tuple(path)


def validate(model: type[M], document: Document) -> M:
    """Return the document as ``model``; text is never read as a number, lists serve as tuples.

    Raises:
        ScenarioError: one line per error, at most ten.
    """
    if not isinstance(document.data, dict):
        raise ScenarioError(
            f"{document.where()} the file must be a mapping; got {_described(document.data)}."
        )
    try:
        return model.model_validate_json(json.dumps(document.data), strict=True)
    except ValidationError as error:
        raise ScenarioError(_error_text(model, document, error)) from None


def _error_text(model: type[BaseModel], document: Document, error: ValidationError) -> str:
    """Return a line for each error, up to `MAX_ERRORS`, and the number of further errors."""
    details = [
        detail
        for detail in error.errors(include_url=False, include_input=False)
        if not _is_long_enough(document.data, detail)
    ]
    found = [_error(model, document, detail) for detail in details[: _LOOK_AHEAD * MAX_ERRORS]]
    merged = _merge(found)
    shown = merged[:MAX_ERRORS]
    lines = [error_line.text for error_line in shown]
    more = len(merged) - len(shown) + len(details) - len(found)
    return "\n".join([*lines, f"… and {more} more."] if more else lines)


def _is_long_enough(data: Any, detail: ErrorDetails) -> bool:
    """Whether a list is reported as too short only because one of its entries is wrong."""
    if detail["type"] != "too_short":
        return False
    got = _value(data, _real(data, detail["loc"], "too_short"))
    return isinstance(got, list) and len(got) >= detail["ctx"]["min_length"]


@dataclass(frozen=True)
class _Error:
    """An error at a path; if ``must`` is not empty, the text is built from it."""

    at: str
    path: tuple[PathKey, ...]
    message: str = ""
    must: str = ""
    got: str = ""
    hint: str = ""
    of_type: bool = False  # the error is about the type of the value

    @property
    def text(self) -> str:
        """The error in one line."""
        message = f"{self.must}; got {self.got}.{self.hint}" if self.must else self.message
        return f"{self.at} {message}"


def _merge(found: Sequence[_Error]) -> list[_Error]:
    """Merge the errors of all alternatives of a union that one value missed.

    If an error further inside shows which alternative fits, the others are dropped.
    """
    deeper = {c.path[:k] for c in found for k in range(len(c.path))}
    merged: dict[object, _Error] = {}
    for k, c in enumerate(found):
        if c.of_type and c.path in deeper:
            continue
        key: object = (c.path, True) if c.of_type else k
        before = merged.get(key)
        if before is None:
            merged[key] = c
        else:
            must = f"{before.must}, or {c.must.removeprefix('must be ')}"
            merged[key] = replace(before, must=must, hint=before.hint or c.hint)
    return list(merged.values())


def _error(model: type[BaseModel], document: Document, detail: ErrorDetails) -> _Error:
    context = detail.get("ctx", {})
    own = context.get("error")
    loc: tuple[PathKey, ...] = detail["loc"]
    path = _real(document.data, loc, detail["type"])
    if isinstance(own, FieldError):
        path += own.path
    at = document.where(path) if path else f"{document.where()} the file"
    got = _value(document.data, path)
    kind = detail["type"]
    if kind == "extra_forbidden":
        known = _keys(model, document.data, path[:-1])
        return _Error(at, path, f"is not a known key.{_hint(str(path[-1]), known)}")
    if kind == "missing":
        return _Error(at, path, "must be given.")
    if own is not None:
        return _Error(at, path, f"{own}{'' if str(own).endswith(('.', '?')) else '.'}")
    must = requirement(detail)
    hint, of_type = "", kind in _OF_TYPE
    if kind in {"literal_error", "union_tag_invalid", "enum"} and got is not _ABSENT:
        expected = str(context.get("expected", context.get("expected_tags", "")))
        tag = got.get("type") if isinstance(got, dict) and kind == "union_tag_invalid" else got
        hint = did_you_mean(str(tag)[:100], [e for e in expected.split("'") if e.strip(", or")])
        got = tag
    return _Error(at, path, must=must, got=_described(got), hint=hint, of_type=of_type)


_ABSENT = object()


def _described(value: object) -> str:
    if value is _ABSENT or value is None:
        return "nothing"
    if isinstance(value, dict):
        return f"a mapping ({', '.join(shown(k, 20) for k in list(value)[:4]) or 'empty'})"
    if isinstance(value, list | tuple):
        return f"a list of {len(value)}"
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(shown(value)) if isinstance(value, str) else shown(value)


def _holds(data: Any, key: PathKey) -> bool:
    if isinstance(data, list):
        return isinstance(key, int) and key < len(data)
    return isinstance(data, dict) and isinstance(key, str) and key in data


def _value(data: Any, path: Sequence[PathKey]) -> Any:
    for key in path:
        if not _holds(data, key):
            return _ABSENT
        data = data[key]
    return data


def _real(data: Any, loc: Sequence[PathKey], kind: str) -> tuple[PathKey, ...]:
    """Return the location without the union tags that pydantic inserts."""
    path: list[PathKey] = []
    tag = _tag(data)
    for index, key in enumerate(loc):
        if key == tag:
            tag = None  # a union's tag comes first and may also be the name of a key
        elif _holds(data, key):
            data = data[key]
            tag = _tag(data)
            path.append(key)
        elif kind == "missing" and index == len(loc) - 1:
            path.append(key)
    return tuple(path)


def _tag(data: Any) -> str | None:
    tag = data.get("type") if isinstance(data, dict) else None
    return tag if isinstance(tag, str) else None


@lru_cache(maxsize=32)
def _schema(model: type[BaseModel]) -> Schema:
    return model.model_json_schema()


def _keys(model: type[BaseModel], data: Any, path: Sequence[PathKey]) -> list[str]:
    """Return the keys that the schema allows for the mapping at ``path``."""
    root = _schema(model)
    nodes = _branches(root, root, data)
    for key in path:
        data = data[key]
        below: list[Schema] = []
        for node in nodes:
            step = _step(node, key)
            if step is not None:
                below += _branches(root, step, data)
        nodes = below
    return sorted({key for node in nodes for key in node.get("properties", {})})


def _step(node: Schema, key: PathKey) -> Schema | None:
    if isinstance(key, str):
        others = [node.get("additionalProperties"), *node.get("patternProperties", {}).values()]
        found = node.get("properties", {}).get(key, others[-1])
    else:
        fixed = node.get("prefixItems", [])
        found = fixed[key] if key < len(fixed) else node.get("items")
    return found if isinstance(found, dict) else None


def _branches(root: Schema, node: Schema, data: Any) -> list[Schema]:
    """Return the alternatives of a schema node, with references resolved, narrowed by `type`."""
    if "$ref" in node:
        name = node["$ref"].rsplit("/", 1)[-1]
        return _branches(root, root["$defs"][name], data)
    mapping = node.get("discriminator", {}).get("mapping", {})
    tag = data.get("type") if isinstance(data, dict) else None
    if isinstance(tag, str) and tag in mapping:
        return _branches(root, {"$ref": mapping[tag]}, data)
    union = [*node.get("oneOf", []), *node.get("anyOf", []), *node.get("allOf", [])]
    return [b for part in union for b in _branches(root, part, data)] or [node]


def _hint(key: str, known: list[str]) -> str:
    near = did_you_mean(key, known)
    if near or not known:
        return near
    listed = ", ".join(known[:12]) + (", …" if len(known) > 12 else "")
    return f" Known keys: {listed}."
