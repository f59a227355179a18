"""Make plugins from specs: a name or ``{type: name, …parameters}``, from a file or a caller."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from pydantic import BaseModel, ValidationError

from benchnav.config.model_errors import parameter_errors
from benchnav.errors import (
    BenchnavError,
    BrokenPluginError,
    ConfigError,
    PluginError,
    UnknownPluginError,
    did_you_mean,
)
from benchnav.navigation.command_check import exception_text
from benchnav.navigation.hierarchy.composition import HIERARCHICAL, hint, is_pair, parameters_of
from benchnav.plugins import NAVIGATORS, Registry
from benchnav.text.visible import shortened

Spec = str | Mapping[str, Any]
Where = str | Callable[[str], str]
"""The place of a spec, for messages: a text, or parameter → text, with "" for the spec itself."""


def make(registry: Registry, spec: Spec, *, where: Where = "") -> Any:
    """Return the plugin that ``spec`` names, constructed with its parameters.

    Args:
        registry: the kind of plugin, e.g. ``benchnav.plugins.NAVIGATORS``.
        spec: a name, or a mapping with ``type`` and that plugin's parameters; a navigator's
            name may consist of its parts' names (`benchnav.navigation.hierarchy.composition`).
        where: the place of the spec (``"suite.yaml:12: navigators[0]"``), for messages;
            or a function that returns the place of each parameter.

    Raises:
        ConfigError: the spec has neither form, or the Config refuses a parameter.
        UnknownPluginError, PluginConflictError, BrokenPluginError: as Registry.load;
            BrokenPluginError also if the plugin cannot be constructed.
    """
    plugin, config = configure(registry, spec, where=where)
    try:
        return plugin(config)
    except BenchnavError:
        raise
    except (Exception, SystemExit) as error:
        name, _ = _written(registry, spec, where)
        raise BrokenPluginError(
            f"{_at(where)}The {registry.kind} {name!r} cannot be made: {exception_text(error)}."
        ) from error


def configure(registry: Registry, spec: Spec, *, where: Where = "") -> tuple[Any, BaseModel]:
    """Return the class that ``spec`` names and its validated Config, without an instance.

    Raises what `make` raises.
    """
    name, parameters = split(registry, spec, where=where)
    try:
        plugin = registry.load(name)
    except UnknownPluginError as error:
        also = hint(name) if registry is NAVIGATORS else ""
        raise UnknownPluginError(f"{error}{also}") from None
    declared = getattr(plugin, "Config", None)
    if not (isinstance(declared, type) and issubclass(declared, BaseModel)):
        raise BrokenPluginError(
            f"{_at(where)}The {registry.kind} {name!r} must be a class with a pydantic Config."
            f" Got {plugin!r} instead."
        )
    try:
        return plugin, declared(**parameters)
    except ValidationError as error:
        written, _ = _written(registry, spec, where)
        lines = parameter_errors(error, declared, f"{registry.kind} {written!r}")
        if isinstance(where, str):
            raise ConfigError(_at(where) + "\n".join(text for _, text in lines)) from None
        raise ConfigError("\n".join(_at(where, key) + text for key, text in lines)) from None
    except PluginError as error:  # of a part that the Config names
        raise type(error)(_at(where) + str(error)) from error.__cause__
    except BenchnavError:
        raise
    except (Exception, SystemExit) as error:
        written, _ = _written(registry, spec, where)
        raise BrokenPluginError(
            f"{_at(where)}The Config of the {registry.kind} {written!r} cannot be made:"
            f" {exception_text(error)}."
        ) from error


def split(registry: Registry, spec: Spec, *, where: Where = "") -> tuple[str, dict[str, Any]]:
    """Return (registered name, parameters) of a spec; a pair is converted to `hierarchical`.

    Raises ConfigError if the spec has neither form, and UnknownPluginError for a pair with an
    unknown part.
    """
    name, parameters = _written(registry, spec, where)
    if registry is not NAVIGATORS or not is_pair(name):
        return name, parameters
    try:
        return HIERARCHICAL, parameters_of(name, parameters)
    except PluginError as error:
        raise type(error)(_at(where) + str(error)) from None


def _written(registry: Registry, spec: Spec, where: Where) -> tuple[str, dict[str, Any]]:
    """Return (name, parameters) of a spec, without conversion of pairs."""
    if isinstance(spec, str):
        return spec, {}
    rule = f"{_at(where)}A {registry.kind} must be a name or {{type: name, …parameters}}."
    if not isinstance(spec, Mapping):
        raise ConfigError(f"{rule} Got {_short(spec)} instead.")
    strange = [key for key in spec if not isinstance(key, str)]
    if strange:
        raise ConfigError(f"{rule} Got the key {_short(strange[0])}, which is not text, instead.")
    if "type" not in spec:
        near = did_you_mean("type", spec).replace("Did you mean", "Should 'type' be written for")
        raise ConfigError(f"{rule} Got no 'type' among {_listed(spec)} instead.{near}")
    name = spec["type"]
    if not isinstance(name, str):
        raise ConfigError(f"{rule} Got the type {_short(name)} instead.")
    return name, {key: value for key, value in spec.items() if key != "type"}


def _at(where: Where, parameter: str = "") -> str:
    text = where if isinstance(where, str) else where(parameter)
    return f"{text}: " if text else ""


def _listed(names: Iterable[object]) -> str:
    return ", ".join(repr(name) for name in names) or "nothing"


def _short(value: object) -> str:
    return shortened(repr(value), 80)
