"""Parameters: numbers that a scenario file leaves open, with a default and bounds.

A file declares ``parameters: {followers: {default: 24, low: 1, high: 249}}`` and has
``{parameter: followers}`` in place of the number. ``family/name:followers=100``
is then the scenario with another number. Hashes, stored scenarios and draws use the
number, never its name.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from pydantic import Field, model_validator

from benchnav.config.document import Document, PathKey, shown
from benchnav.config.validation import FieldError, validate
from benchnav.errors import ScenarioError, UsageError, did_you_mean
from benchnav.scenario.base import Name, Spec

Given = Mapping[str, float]
LARGEST = 1e9


class Parameter(Spec):
    """A number that users of the scenario can set with `NAME:key=number`."""

    default: float = Field(ge=-LARGEST, le=LARGEST, description="value if none is given")
    low: float = Field(ge=-LARGEST, le=LARGEST, description="smallest allowed value")
    high: float = Field(ge=-LARGEST, le=LARGEST, description="largest allowed value")
    description: str = Field("", max_length=500, description="meaning of the number")

    @property
    def whole(self) -> bool:
        """Whether default and bounds are whole numbers: then the value must be one, too."""
        return all(x == int(x) for x in (self.default, self.low, self.high))

    @model_validator(mode="after")
    def _check(self) -> "Parameter":
        if not self.low <= self.default <= self.high:
            raise FieldError(
                ("default",), f"must be from {self.low:g} to {self.high:g}; got {self.default:g}"
            )
        return self


Parameters = dict[Name, Parameter]


class Reference(Spec):
    """A reference to a parameter of the scenario, in place of a number."""

    parameter: Name = Field(description="name of the parameter")


class _Declared(Spec):
    parameters: Parameters


def split_parameters(name: str) -> tuple[str, dict[str, float]]:
    """Split ``"yard:agents=3,gap=0.5"`` into ``"yard", {"agents": 3.0, "gap": 0.5}``.

    Raises UsageError if the text after the last colon contains ``=`` and is malformed.
    """
    base, colon, rest = name.rpartition(":")
    if not colon or "=" not in rest:
        return name, {}
    given: dict[str, float] = {}
    for part in rest.split(","):
        key, _, text = part.partition("=")
        try:
            given[key] = float(text)
        except ValueError:
            given[key] = math.nan
        if not key or not math.isfinite(given[key]):
            raise UsageError(
                f"Parameters of a scenario must be written NAME:key=number,key=number."
                f" Got {shown(name)!r}."
            )
    return base, given


def joined_parameters(given: Given) -> str:
    """Return ``":agents=3,gap=0.5"``, or ``""`` without parameters."""
    parts = [f"{key}={value:.12g}" for key, value in sorted(given.items())]
    return ":" + ",".join(parts) if parts else ""


def resolve(document: Document, given: Given) -> tuple[Document, dict[str, float]]:
    """Return the document with numbers in place of parameters, and the values off their default.

    Raises:
        ScenarioError: a declaration is wrong, or a reference has an unknown name.
        UsageError: ``given`` has an unknown parameter, or one out of bounds.
    """
    data = document.data
    if not isinstance(data, dict) or "parameters" not in data:
        if given:
            raise UsageError(f"{document.name} has no parameters; got {', '.join(given)}.")
        return document, {}
    declared = validate(_Declared, replace(document, data={"parameters": data["parameters"]}))
    values = {name: p.default for name, p in declared.parameters.items()}
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


def _check_given(where: str, declared: Parameters, name: str, value: float) -> None:
    if name not in declared:
        raise UsageError(
            f"{where} has the parameters {', '.join(declared)}; got {shown(name)!r}."
            f"{did_you_mean(name, declared)}"
        )
    p = declared[name]
    if not p.low <= value <= p.high or (p.whole and value != int(value)):
        kind = "a whole number" if p.whole else "a number"
        raise UsageError(
            f"The parameter {name!r} of {where} must be {kind} from {p.low:g} to {p.high:g};"
            f" got {value:g}."
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
    return int(value) if value == int(value) else value
