"""Classes, instances and functions as navigators, written as a file would name them.

A class or function that a worker process can import is named by its module. Others are
registered in this process, which then runs them itself.
"""

import copy
import sys
from collections.abc import Callable, Iterable, Mapping
from types import FunctionType
from typing import Any

from benchnav.errors import UsageError
from benchnav.navigation.navigator import Navigator, PluginConfig
from benchnav.navigation.plugin.configure import Spec
from benchnav.navigation.plugin.function_navigator import function_class
from benchnav.plugins import NAVIGATORS
from benchnav.source.importable import MAIN, is_importable

NavigatorLike = str | Mapping[str, Any] | type[Navigator] | Navigator | Callable[..., Any]
"""A name, ``{"type": name, …parameters}``, a class, an instance, or a function."""
Navigators = NavigatorLike | Iterable[NavigatorLike] | Mapping[str, NavigatorLike]
"""One navigator, several, or ``{label: navigator}``."""

_RULE = (
    "A navigator must be a name, {'type': name, …parameters}, a class derived from"
    " benchnav.navigation.Navigator, an instance of one, or a function"
)


def navigator_specs(navigators: Navigators | None) -> tuple[Spec, ...]:
    """Return specs of one or more navigators; none for None.

    Raises UsageError for a value that is no navigator.
    """
    session = _Session()
    if navigators is None:
        return ()
    if isinstance(navigators, Mapping) and "type" not in navigators:
        named = ((label, session.spec(n)) for label, n in navigators.items())
        return tuple(_with_label(spec, label) for label, spec in named)
    if isinstance(navigators, Iterable) and not isinstance(navigators, str | Mapping):
        return tuple(session.spec(navigator) for navigator in navigators)
    return (session.spec(navigators),)


def navigator_spec(navigator: Any) -> Spec:
    """Return one navigator as a name or ``{"type": name, …}``.

    A class keeps the name under which it is registered. Its label in tables is that name, or
    the name of the class or function.
    """
    return _Session().spec(navigator)


class _Session:
    """Names classes and functions, each object that this process alone knows once."""

    def __init__(self) -> None:
        self._taken: set[str] = set()

    def spec(self, navigator: Any) -> Spec:
        if isinstance(navigator, str):
            return navigator
        if isinstance(navigator, Mapping):
            return self._of_mapping(navigator)
        if isinstance(navigator, Navigator):
            return self._of_instance(navigator)
        if isinstance(navigator, type) and issubclass(navigator, Navigator):
            return self._of_class(navigator)
        if callable(navigator) and not isinstance(navigator, type):
            return self._of_function(navigator)
        raise UsageError(f"{_RULE}. Got {navigator!r} instead.")

    def _of_mapping(self, spec: Mapping[str, Any]) -> Spec:
        kind = spec.get("type")
        if isinstance(kind, str) or kind is None:
            return dict(spec)
        return {**_mapping(self.spec(kind)), **{k: v for k, v in spec.items() if k != "type"}}

    def _of_class(self, kind: type[Navigator]) -> Spec:
        place = f"{kind.__module__}:{kind.__qualname__}"
        for name in NAVIGATORS.names():
            if NAVIGATORS.source(name).value == place and NAVIGATORS.load(name) is kind:
                return name
        if is_importable(kind):
            return {"type": place, "label": kind.__name__}
        return self._registered(kind, kind.__name__)

    def _of_instance(self, navigator: Navigator) -> Spec:
        """The class with its Config, where the instance was made from nothing else."""
        kind, config = type(navigator), navigator.config
        if isinstance(config, PluginConfig) and _follows_from_config(navigator):
            given = config.model_dump(mode="json", exclude_unset=True)
            return {**_mapping(self._of_class(kind)), **given}

        def make(cls: Any, config: PluginConfig | None = None) -> Navigator:
            copied: Navigator = copy.deepcopy(cls.prototype)
            return copied

        members = {
            "__new__": make, "prototype": navigator, "state": _plain(navigator),
            "Config": PluginConfig, "__module__": kind.__module__,
        }  # fmt: skip
        return self._registered(type(kind.__name__, (kind,), members), kind.__name__)

    def _of_function(self, function: Callable[..., Any]) -> Spec:
        base = function_class(function)
        name = getattr(function, "__name__", type(function).__name__)
        label = "function" if name == "<lambda>" else name
        if isinstance(function, FunctionType) and is_importable(function):
            place = f"{base.__module__}:{base.__qualname__}"
            where = f"{function.__module__}:{function.__qualname__}"
            return {"type": place, "function": where, "label": label}
        module = getattr(function, "__module__", None) or MAIN
        members = {
            "function": staticmethod(function), "Config": PluginConfig,
            "__doc__": function.__doc__, "__module__": module,
        }  # fmt: skip
        return self._registered(type(label, (base,), members), label)

    def _registered(self, kind: Any, label: str) -> Spec:
        """The name under which this process knows a class that no other process can import."""
        name, number = label, 1
        while name in self._taken or (name in NAVIGATORS and not NAVIGATORS.is_local(name)):
            number += 1
            name = f"{label}#{number}"
        self._taken.add(name)
        if kind.__qualname__ == kind.__name__ == label and not _is_defined(kind):
            kind.__qualname__ = f"<locals>.{name}"  # a place of its own
        NAVIGATORS.replace(name, kind)
        return name


def _is_defined(kind: type) -> bool:
    """Whether the class stands in its module under its name."""
    return getattr(sys.modules.get(kind.__module__), kind.__qualname__, None) is kind


def _follows_from_config(navigator: Navigator) -> bool:
    """Whether the class, made from the same Config, has the same plain attributes."""
    try:
        return _plain(type(navigator)(navigator.config)) == _plain(navigator)
    except Exception:
        return False


def _plain(navigator: Navigator) -> dict[str, Any]:
    """The attributes that are numbers, texts and the like."""
    plain = (type(None), bool, int, float, str, tuple)
    return {k: v for k, v in vars(navigator).items() if isinstance(v, plain)}


def _mapping(spec: Spec) -> dict[str, Any]:
    return {"type": spec} if isinstance(spec, str) else dict(spec)


def _with_label(spec: Spec, label: str) -> Spec:
    return {**_mapping(spec), "label": label}
