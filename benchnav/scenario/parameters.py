"""Parameters: values that a scenario file leaves open, with a default.

A file declares ``parameters: {followers: {default: 24, low: 1, high: 249}}`` and has
``{parameter: followers}`` in place of the number. ``family/name:followers=100``
is then the scenario with another number. A default that is text or true or false makes a
parameter of that type: ``family/name:robot=jackal``. Hashes, stored scenarios and draws use the
value, never its name.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any

from pydantic import Field, model_validator

from benchnav.config.document import Document, PathKey, shown
from benchnav.config.validation import FieldError, validate
from benchnav.errors import ScenarioError, UsageError, did_you_mean
from benchnav.scenario.base import Name, Spec

Value = float | str | bool
Given = Mapping[str, Value]
LARGEST = 1e9
_TEXT = r"^[A-Za-z0-9_][A-Za-z0-9_./-]*$"  # stays one part of NAME:key=value,key=value
_WORDS = {"true": True, "false": False}


def _is_none(value: object) -> bool:
    return value is None


class Parameter(Spec):
    """A value that users of the scenario can set with `NAME:key=value`."""

    default: (
        Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
        | bool
        | Annotated[str, Field(pattern=_TEXT, max_length=100)]
    ) = Field(description="value if none is given: a number, text, or true or false")
    low: float | None = Field(
        None,
        ge=-LARGEST,
        le=LARGEST,
        exclude_if=_is_none,
        description="smallest allowed number; a number must have it",
    )
    high: float | None = Field(
        None,
        ge=-LARGEST,
        le=LARGEST,
        exclude_if=_is_none,
        description="largest allowed number; a number must have it",
    )
    choices: tuple[str, ...] | None = Field(
        None,
        min_length=1,
        max_length=100,
        exclude_if=_is_none,
        description="allowed texts; default: any text",
    )
    description: str = Field("", max_length=500, description="meaning of the value")

    @property
    def is_number(self) -> bool:
        """Whether the value is a number, neither text nor true or false."""
        return not isinstance(self.default, bool | str)

    @property
    def allowed(self) -> str:
        """The rule for a value: "a whole number from 1 to 40"."""
        if isinstance(self.default, bool):
            return "true or false"
        if isinstance(self.default, str):
            return f"one of {', '.join(self.choices)}" if self.choices else "text"
        low, high = self._bounds
        return f"a {'whole ' if self._whole else ''}number from {low:g} to {high:g}"

    @property
    def _whole(self) -> bool:
        """Whether default and bounds are whole numbers: then the value must be one, too."""
        numbers = (float(self.default), *self._bounds)
        return all(x == int(x) for x in numbers)

    @property
    def _bounds(self) -> tuple[float, float]:
        low, high = self.low, self.high
        return (-LARGEST if low is None else low, LARGEST if high is None else high)

    def allows(self, value: Value) -> bool:
        """Whether ``value`` has the type of the default and is allowed."""
        if isinstance(self.default, bool) or isinstance(value, bool):
            return isinstance(self.default, bool) and isinstance(value, bool)
        if isinstance(self.default, str) or isinstance(value, str):
            same = isinstance(self.default, str) and isinstance(value, str)
            return same and (self.choices is None or value in self.choices)
        low, high = self._bounds
        return low <= value <= high and not (self._whole and value != int(value))

    @model_validator(mode="after")
    def _check(self) -> "Parameter":
        bounds = {"low": self.low, "high": self.high}
        for key, bound in bounds.items():
            if self.is_number and bound is None:
                raise FieldError((key,), "must be given for a number")
            if not self.is_number and bound is not None:
                raise FieldError((key,), "must be left out: the default is not a number")
        if self.choices is not None and not isinstance(self.default, str):
            raise FieldError(("choices",), "must be left out: the default is not text")
        if not self.allows(self.default):
            rule = self.allowed.removeprefix("a whole number ").removeprefix("a number ")
            raise FieldError(("default",), f"must be {rule}; got {written(self.default)}")
        return self


Parameters = dict[Name, Parameter]


class Reference(Spec):
    """A reference to a parameter of the scenario, in place of a value."""

    parameter: Name = Field(description="name of the parameter")


class _Declared(Spec):
    parameters: Parameters


def split_parameters(name: str) -> tuple[str, dict[str, Value]]:
    """Split ``"yard:agents=3,robot=jackal"`` into ``"yard", {"agents": 3.0, "robot": "jackal"}``.

    Raises UsageError if the text after the last colon contains ``=`` and is malformed.
    """
    base, colon, rest = name.rpartition(":")
    if not colon or "=" not in rest:
        return name, {}
    given: dict[str, Value] = {}
    for part in rest.split(","):
        key, _, text = part.partition("=")
        value = _value(text)
        if not key or value is None:
            raise UsageError(
                f"Parameters of a scenario must be written NAME:key=value,key=value."
                f" Got {shown(name)!r}."
            )
        given[key] = value
    return base, given


def _value(text: str) -> Value | None:
    """Return the value that a text stands for; None if it stands for none."""
    if text in _WORDS:
        return _WORDS[text]
    try:
        number = float(text)
    except ValueError:
        return text if re.match(_TEXT, text) else None
    return number if math.isfinite(number) else None


def joined_parameters(given: Given) -> str:
    """Return ``":agents=3,robot=jackal"``, or ``""`` without parameters."""
    parts = [f"{key}={written(value)}" for key, value in sorted(given.items())]
    return ":" + ",".join(parts) if parts else ""


def written(value: Value) -> str:
    """Return a value as in a name: ``3``, ``jackal``, ``true``."""
    if isinstance(value, bool):
        return str(value).lower()
    return value if isinstance(value, str) else f"{value:.12g}"


def resolve(document: Document, given: Given) -> tuple[Document, dict[str, Value]]:
    """Return the document with values in place of parameters, and the values off their default.

    Raises:
        ScenarioError: a declaration is wrong, or a reference has an unknown name.
        UsageError: ``given`` has an unknown parameter, or a value that is not allowed.
    """
    data = document.data
    if not isinstance(data, dict) or "parameters" not in data:
        if given:
            raise UsageError(f"{document.name} has no parameters; got {', '.join(given)}.")
        return document, {}
    declared = validate(_Declared, replace(document, data={"parameters": data["parameters"]}))
    values: dict[str, Value] = {name: p.default for name, p in declared.parameters.items()}
    for name, value in given.items():
        _check_given(document.name, declared.parameters, name, value)
        values[name] = value
    used: set[str] = set()
    resolved = {
        key: part if key == "parameters" else _substitute(part, (key,), document, values, used)
        for key, part in data.items()
    }
    for name in values:
        if name not in used:
            raise ScenarioError(f"{document.where(('parameters', name))} is not used.")
    chosen = {n: v for n, v in values.items() if v != declared.parameters[n].default}
    return replace(document, data=resolved), chosen


def _check_given(where: str, declared: Parameters, name: str, value: Value) -> None:
    if name not in declared:
        raise UsageError(
            f"{where} has the parameters {', '.join(declared)}; got {shown(name)!r}."
            f"{did_you_mean(name, declared)}"
        )
    p = declared[name]
    if not p.allows(value):
        near = did_you_mean(str(value), p.choices or ())
        raise UsageError(
            f"The parameter {name!r} of {where} must be {p.allowed}; got {written(value)}.{near}"
        )


def _substitute(
    node: Any, path: tuple[PathKey, ...], document: Document, values: Given, used: set[str]
) -> Any:
    if isinstance(node, list):
        return [
            _substitute(child, (*path, i), document, values, used) for i, child in enumerate(node)
        ]
    if not isinstance(node, dict):
        return node
    if set(node) != {"parameter"}:
        return {
            key: _substitute(child, (*path, key), document, values, used)
            for key, child in node.items()
        }
    name = node["parameter"]
    if not isinstance(name, str) or name not in values:
        raise ScenarioError(
            f"{document.where((*path, 'parameter'))} must be one of the scenario's parameters"
            f" {', '.join(values)}; got {shown(name)!r}.{did_you_mean(str(name)[:100], values)}"
        )
    used.add(name)
    value = values[name]
    if isinstance(value, bool | str):
        return value
    return int(value) if value == int(value) else value
