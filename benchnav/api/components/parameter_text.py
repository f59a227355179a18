"""The parameters and the needs of a plugin, as text."""

import re
from collections.abc import Collection
from typing import Any, get_args

from benchnav.errors import BenchnavError
from benchnav.navigation.navigator import ALL_DYNAMICS, DynamicsName
from benchnav.plugins import Registry
from benchnav.text.plural import listed

WIDEST = 40  # characters of a type
UNKNOWN_BEFORE_CONSTRUCTION = "inputs that depend on its parameters"


def parameters(plugin: Any) -> list[tuple[str, str, str, str]]:
    """Return name, type, default and description of every parameter; [] without parameters."""
    return [
        (key, _type(field.annotation), _default(field), field.description or "")
        for key, field in (plugin.Config.model_fields if hasattr(plugin, "Config") else {}).items()
    ]


def needs(registry: Registry, name: str) -> str:
    """Return the needs of the plugin with its default parameters."""
    made = _made(registry, name)
    if isinstance(made, str):
        return made
    return ", ".join(sorted(made.required)) or "nothing beyond its own state and goal"


def answers(registry: Registry, name: str) -> str:
    """Return the command kind of the plugin with its default parameters."""
    made = _made(registry, name)
    return f"a {'command' if isinstance(made, str) else made.command} per agent"


def drives(registry: Registry, name: str) -> str:
    """Return the bodies that the plugin can drive with its default parameters."""
    made = _made(registry, name)
    return "bodies that depend on its parameters" if isinstance(made, str) else bodies(made.drives)


def bodies(dynamics: Collection[str]) -> str:
    """Return the dynamics of bodies as text."""
    if set(dynamics) == ALL_DYNAMICS:
        return "all bodies"
    names = [name for name in get_args(DynamicsName) if name in dynamics]
    return f"{listed(names)} bodies"


def _made(registry: Registry, name: str) -> Any:
    """Return the plugin made without parameters; if it cannot be made, a text with the reason."""
    from benchnav.navigation.plugin.configure import make

    if name in registry.names():  # it is not a pair
        declared = registry.load(name).Config.model_fields.values()
        if any(field.is_required() for field in declared):
            return UNKNOWN_BEFORE_CONSTRUCTION
    try:
        return make(registry, name)
    except BenchnavError as error:
        return f"unknown inputs, because it cannot be made: {error}"


def _type(annotation: Any) -> str:
    if isinstance(annotation, type):
        return annotation.__name__
    text = re.sub(r"\b(?:\w+\.)+(?=\w)", "", str(annotation)).replace("NoneType", "None")
    return text if len(text) <= WIDEST else "one of several"  # the description lists them


def _default(field: Any) -> str:
    if field.is_required():
        return "must be given"
    return f"= {field.get_default(call_default_factory=True)!r}"
