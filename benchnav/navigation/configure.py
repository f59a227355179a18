"""From a name or ``{type: name, …params}``, as a file or a caller wrote it, to a plugin."""

from collections.abc import Iterable, Mapping
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from benchnav.errors import BenchnavError, BrokenPluginError, ConfigError, did_you_mean
from benchnav.plugins import Registry

Spec = str | Mapping[str, Any]


def make(registry: Registry, spec: Spec, *, where: str = "") -> Any:
    """The plugin that ``spec`` names, made from the Config that it describes.

    Args:
        registry: the kind of plugin, e.g. ``benchnav.plugins.NAVIGATORS``.
        spec: a name, or a mapping with ``type`` and that plugin's parameters.
        where: what the spec stands at (``"suite.yaml:12: navigators[0]"``), for messages.

    Raises:
        ConfigError: the spec is neither form, or the Config refuses a parameter.
        UnknownPluginError, PluginConflictError, BrokenPluginError: as Registry.load,
            and the last one also where the plugin cannot be constructed.
    """
    plugin, config = configure(registry, spec, where=where)
    try:
        return plugin(config)
    except BenchnavError:
        raise
    except Exception as error:
        name, _ = split(registry, spec, where=where)
        raise BrokenPluginError(
            f"{_at(where)}The {registry.kind} {name!r} cannot be made:"
            f" {type(error).__name__}: {error}."
        ) from error


def configure(registry: Registry, spec: Spec, *, where: str = "") -> tuple[Any, BaseModel]:
    """The class that ``spec`` names and its validated Config; nothing is constructed.

    Raises what `make` raises.
    """
    name, parameters = split(registry, spec, where=where)
    plugin = registry.load(name)
    declared = getattr(plugin, "Config", None)
    if not (isinstance(declared, type) and issubclass(declared, BaseModel)):
        raise BrokenPluginError(
            f"{_at(where)}The {registry.kind} {name!r} must be a class with a pydantic Config."
            f" Got {plugin!r} instead."
        )
    try:
        return plugin, declared(**parameters)
    except ValidationError as error:
        subject = f"{registry.kind} {name!r}"
        lines = [_explain(subject, declared, detail) for detail in error.errors()]
        raise ConfigError(_at(where) + "\n".join(lines)) from None


def split(registry: Registry, spec: Spec, *, where: str = "") -> tuple[str, dict[str, Any]]:
    """(name, parameters) of either form of a spec.

    Raises ConfigError where it is neither.
    """
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


def _explain(subject: str, declared: type[BaseModel], detail: ErrorDetails) -> str:
    place = detail["loc"]
    key = ".".join(str(part) for part in place)
    if detail["type"] == "extra_forbidden":
        known = list(declared.model_fields) if len(place) == 1 else []
        near = did_you_mean(str(place[-1]), known)
        has = f" It has {_listed(known)}." if known and not near else ""
        none = " It has none." if len(place) == 1 and not known else ""
        return f"The {subject} has no parameter {key!r}.{near}{has}{none}"
    if detail["type"] == "missing":
        return f"The {subject} must be given the parameter {key!r}. Got nothing instead."
    rule = detail["msg"].removeprefix("Input should be ").removeprefix("Value error, ")
    what = f"The parameter {key!r} of the {subject}" if key else f"The {subject}"
    return f"{what} must be {rule}. Got {_short(detail['input'])} instead."


def _at(where: str) -> str:
    return f"{where}: " if where else ""


def _listed(names: Iterable[object]) -> str:
    return ", ".join(repr(name) for name in names) or "nothing"


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."
