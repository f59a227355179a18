"""The errors of pydantic models as sentences; every message on an invalid value starts here."""

import re
from collections.abc import Iterable
from itertools import groupby
from types import UnionType
from typing import Any, NamedTuple, Union, get_origin

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from benchnav.errors import did_you_mean
from benchnav.text.visible import shortened

_MUST_BE = {
    "missing": "must be given", "union_tag_not_found": "must have the key `type`",
    "float_type": "must be a number", "float_parsing": "must be a number",
    "int_type": "must be a whole number", "int_parsing": "must be a whole number",
    "int_from_float": "must be a whole number", "finite_number": "must be finite",
    "bool_type": "must be true or false", "bool_parsing": "must be true or false",
    "string_type": "must be text", "path_type": "must be a path",
    "dict_type": "must be a mapping", "model_type": "must be a mapping",
    "model_attributes_type": "must be a mapping", "list_type": "must be a list",
    "tuple_type": "must be a list", "dataclass_type": "must be a mapping",
}  # fmt: skip
_BOUND = {
    "json_invalid": "must be JSON: {error}",
    "greater_than": "must be > {gt}", "greater_than_equal": "must be ≥ {ge}",
    "less_than": "must be < {lt}", "less_than_equal": "must be ≤ {le}",
    "literal_error": "must be {expected}", "enum": "must be {expected}",
    "too_short": "must have at least {min_length} entries",
    "too_long": "must have at most {max_length} entries",
    "string_too_short": "must have at least {min_length} characters",
    "string_too_long": "must have at most {max_length} characters",
    "string_pattern_mismatch": "must match {pattern}",
    "union_tag_invalid": "must have one of the types {expected_tags}",
}  # fmt: skip
_PREFIX = re.compile(r"^(Input|Value|List|Tuple|String|Dictionary|Set|URL) should ")


class Problem(NamedTuple):
    """The first problem of an invalid value."""

    key: str  # path of the field: ``lines.0.x``; "" for the whole value
    requirement: str  # "must be > 0"
    got: str  # the value as text


def requirement(detail: ErrorDetails) -> str:
    """Return what a value must be, as a phrase that starts with "must"."""
    kind, context = detail["type"], detail.get("ctx", {})
    if kind in _MUST_BE:
        return _MUST_BE[kind]
    if kind in _BOUND:
        numbers = {k: f"{v:g}" if isinstance(v, float) else v for k, v in context.items()}
        return _BOUND[kind].format(**numbers)
    if kind == "extra_forbidden":
        return "must be left out"
    text = detail["msg"].removeprefix("Value error, ").removeprefix("Assertion failed, ")
    text = _PREFIX.sub("must ", text).rstrip(".")
    return text if text.startswith("must ") else f"must be {text}"


def first_problem(error: ValidationError) -> Problem:
    """Return the first of the problems that a model found."""
    detail = error.errors(include_url=False)[0]
    return Problem(_dotted(detail["loc"]), requirement(detail), _short(detail["input"]))


def parameter_errors(
    error: ValidationError, model: type[BaseModel], subject: str, noun: str = "parameter"
) -> list[tuple[str, str]]:
    """Return (parameter, sentence) of each error; all failed branches of a union are one error.

    Args:
        error: of making ``model`` from keyword arguments.
        model: its fields are the parameters.
        subject: that has the parameters: "navigator 'orca'".
        noun: for the parameters.
    """
    lines = []
    details = error.errors(include_url=False)
    for key, group in groupby(details, key=lambda detail: detail["loc"][:1]):
        branches, name = list(group), str(key[0]) if key else ""
        field = model.model_fields.get(name)
        union = field is not None and get_origin(field.annotation) in (Union, UnionType)
        if union and len({branch["loc"] for branch in branches}) > 1:
            lines.append((name, f"The {noun} {name!r} of the {subject} {_alternatives(branches)}"))
        else:
            lines += [(name, _sentence(branch, model, subject, noun)) for branch in branches]
    return lines


def _alternatives(branches: list[ErrorDetails]) -> str:
    rules = dict.fromkeys(_in_union(branch).removeprefix("must be ") for branch in branches)
    whole = next((b["input"] for b in branches if len(b["loc"]) == 2), None)
    got = "" if whole is None else f" Got {_short(whole)} instead."
    return f"must be {', or '.join(rules)}.{got}"


def _in_union(detail: ErrorDetails) -> str:
    if detail["type"] in ("missing", "extra_forbidden"):
        word = "with" if detail["type"] == "missing" else "without"
        return f"a mapping {word} {detail['loc'][-1]!r}"
    return requirement(detail)


def _sentence(detail: ErrorDetails, model: type[BaseModel], subject: str, noun: str) -> str:
    place = detail["loc"]
    key = _dotted(place)
    if detail["type"] == "extra_forbidden":
        known = _known(model, place[:-1])
        near = did_you_mean(str(place[-1]), known)
        has = f" There is {_listed(known)}." if known and not near else ""
        none = " It has none." if len(place) == 1 and not known else ""
        return f"The {subject} has no {noun} {key!r}.{near}{has}{none}"
    if detail["type"] == "missing":
        return f"The {subject} must be given the {noun} {key!r}. Got nothing instead."
    named = f"The {noun} {key!r} of the {subject}" if key else f"The {subject}"
    return f"{named} {requirement(detail)}. Got {_short(detail['input'])} instead."


def _known(model: type[BaseModel], place: Iterable[int | str]) -> list[str]:
    """Return the fields at ``place``; empty if the place is not a nested model."""
    for part in place:
        field = model.model_fields.get(str(part))
        if field is None or not isinstance(field.annotation, type):
            return []
        if not issubclass(field.annotation, BaseModel):
            return []
        model = field.annotation
    return list(model.model_fields)


def _dotted(place: Iterable[int | str]) -> str:
    return ".".join(str(part) for part in place)


def _listed(names: Iterable[object]) -> str:
    return ", ".join(repr(name) for name in names) or "nothing"


def _short(value: Any) -> str:
    """Return a value as text; a value of a plugin may fail to describe itself."""
    try:
        return shortened(repr(value), 80)
    except (Exception, SystemExit):
        return f"a {type(value).__name__}"
