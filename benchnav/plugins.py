"""One registry over entry points: lazy, safe against collisions, and clear about broken plugins.

Names are read from installed distributions without importing code of plugins. Plugins of
benchnav are registered through the same entry points as others, except that an entry point of
its metrics is a module, which is imported to find the names of its metrics. A script or notebook
registers a plugin with a decorator, and ``module:attribute`` is accepted wherever a name is. A kind
of plugin may have a contract, which detects plugins of the wrong type: a function of a higher
layer, which is loaded by its name as plugins are.
"""

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from importlib.metadata import Distribution, EntryPoint, entry_points
from typing import Any, TypeVar

from benchnav.errors import (
    BrokenPluginError,
    PluginConflictError,
    PluginError,
    UnknownPluginError,
    did_you_mean,
)
from benchnav.named_module import load_by_module

T = TypeVar("T")
_LONGEST = 500  # characters of the text of an exception


@dataclass(frozen=True)
class Source:
    """The origin of a name."""

    name: str
    distribution: str  # "benchnav 0.1.0", or "registered in this process"
    value: str  # "package.module:attribute"

    @property
    def is_own(self) -> bool:
        """Whether the plugin is part of benchnav itself."""
        ours = self.distribution.partition(" ")[0] == "benchnav"
        return ours and self.value.startswith("benchnav.")


@dataclass
class Registry:
    """The plugins of one kind, by name."""

    group: str  # entry-point group, "benchnav.navigators"
    kind: str  # "navigator", for messages
    contract: str = ""  # "module:function": (name, plugin) -> the violated rule, or ""
    members: str = ""  # "module:function": (module) -> {name: attribute} of plugins in a module
    _local: dict[str, tuple[Any, str]] = field(default_factory=dict)
    _found: dict[str, list[Source]] | None = None
    _path: list[str] = field(default_factory=list)  # sys.path when they were found

    def register(self, name: str) -> Callable[[T], T]:
        """Return a decorator that registers a plugin in this process only.

        Raises PluginConflictError if another plugin has the name, and PluginError if a run would
        refuse the name or the plugin.
        """
        if not isinstance(name, str) or not name.strip() or ":" in name:
            raise PluginError(
                f"A {self.kind} must be registered under a name, which is text without ':':"
                f" @benchnav.register_{self.kind}('my-name'). Got {name!r} instead."
            )

        def decorate(thing: T) -> T:
            value = _value(thing)
            self._require_contract(name, thing, value)
            taken = self._local.get(name)
            if taken is not None and taken[1] != value:
                raise self._conflict(name, [taken[1], value])
            if name in self._entries():
                raise self._conflict(name, [str(self._entries()[name][0]), value])
            self._local[name] = (thing, value)
            return thing

        return decorate

    def replace(self, name: str, thing: Any) -> None:
        """Register ``thing`` in this process; replace a plugin that this process registered before.

        Raises PluginConflictError if an installed plugin has the name.
        """
        self._local.pop(name, None)
        self.register(name)(thing)

    def names(self) -> list[str]:
        """Return all names, sorted, without importing any plugin."""
        return sorted({*self._entries(), *self._local})

    def __contains__(self, name: str) -> bool:
        return name in self._local or name in self._entries()

    def is_local(self, name: str) -> bool:
        """Whether ``name`` is registered in this process only."""
        return name in self._local

    def registered(self, value: str) -> Any:
        """Return the plugin of this process that is defined at ``value``; None if there is none."""
        return next((thing for thing, place in self._local.values() if place == value), None)

    def registrations(self) -> "list[Registration]":
        """Return all registrations of this process."""
        return [(self.group, name, value) for name, (_, value) in self._local.items()]

    def adopt(self, name: str, value: str) -> None:
        """Register the plugin at ``value``, as another process did; ignore it if it is broken."""
        with suppress(BrokenPluginError):
            self._local[name] = (self._load_by_module(value), value)

    def sources(self) -> list[Source]:
        """Return all entry points of the group, without importing any plugin."""
        return [source for claims in self._entries().values() for source in claims]

    def source(self, name: str) -> Source:
        """Return the origin of ``name``. Raises as `load` for an unknown name or a conflict."""
        if name in self._local:
            return Source(name, "registered in this process", self._local[name][1])
        if ":" in name and name not in self._entries():
            return Source(name, "named by module", name)
        return self._entry(name)

    def load(self, name: str) -> Any:
        """Return the plugin that is registered as ``name``.

        Raises:
            UnknownPluginError: no such name.
            PluginConflictError: two distributions claim it.
            BrokenPluginError: it fails to import, or is of the wrong type.
        """
        if name in self._local:
            return self._local[name][0]
        if ":" in name and name not in self._entries():
            return self._load_by_module(name)
        entry = self._entry(name)
        try:
            thing = EntryPoint(name, entry.value, self.group).load()
        except (Exception, SystemExit) as error:
            raise BrokenPluginError(
                f"The {self.kind} {name!r} cannot be used: {_exception_text(error)}"
                f" (while importing {entry.value}, from {entry.distribution})."
            ) from error
        self._require_contract(name, thing, f"{entry.value}, from {entry.distribution}")
        return thing

    def broken(self) -> Iterator[tuple[str, str]]:
        """Yield (name, cause) of each plugin that cannot be loaded. Imports all plugins."""
        for name in self.names():
            try:
                self.load(name)
            except (BrokenPluginError, PluginConflictError) as error:
                yield name, str(error)

    def _entries(self) -> dict[str, list[Source]]:
        if self._found is None or self._path != sys.path:
            self._found, self._path = {}, [*sys.path]
            for entry in entry_points(group=self.group):
                for source in self._sources(entry):
                    claims = self._found.setdefault(source.name, [])
                    if source not in claims:
                        claims.append(source)
        return self._found

    def _sources(self, entry: EntryPoint) -> list[Source]:
        """Return the sources of an entry point; a module of benchnav itself holds several.

        A module of a plugin is not imported for its names: it must name its plugins one by one.
        """
        source = _source(entry)
        if entry.attr or not (self.members and source.is_own):
            return [source]
        try:
            held = _function(self.members)(import_module(entry.module))
        except Exception:
            return [source]  # `load` reports the cause
        return [
            Source(name, source.distribution, f"{entry.module}:{attribute}")
            for name, attribute in held.items()
        ]

    def _entry(self, name: str) -> Source:
        entries = self._entries()
        if name not in entries:
            raise UnknownPluginError(
                f"There is no {self.kind} {name!r}.{did_you_mean(name, self.names())}"
                f" 'benchnav list {self.kind}s' shows all."
            )
        if len(entries[name]) > 1:
            raise self._conflict(
                name, [f"{source.distribution} ({source.value})" for source in entries[name]]
            )
        return entries[name][0]

    def _load_by_module(self, name: str) -> Any:
        try:
            thing = load_by_module(name)
        except (Exception, SystemExit) as error:
            text = str(error) if isinstance(error, PluginError) else f"{_exception_text(error)}."
            raise BrokenPluginError(f"The {self.kind} {name!r} cannot be used: {text}") from error
        self._require_contract(name, thing, _value(thing))
        return thing

    def _require_contract(self, name: str, thing: Any, origin: str) -> None:
        if not self.contract:
            return
        rule = _function(self.contract)(name, thing)
        if rule:
            raise BrokenPluginError(
                f"The {self.kind} {name!r} must {rule}. Got {_kind_of(thing)} ({origin})."
            )

    def _conflict(self, name: str, claims: list[str]) -> PluginConflictError:
        return PluginConflictError(
            f"The {self.kind} name {name!r} is claimed more than once: {' and '.join(claims)}."
            " Uninstall one, or name what you want as module:Class."
        )


def _value(thing: Any) -> str:
    """Return the place, module:attribute, of a plugin; for a metric, the place of its function."""
    named = thing if hasattr(thing, "__qualname__") else getattr(thing, "function", thing)
    return f"{getattr(named, '__module__', '?')}:{getattr(named, '__qualname__', named)}"


def _function(place: str) -> Any:
    """Return the function ``module:function`` of a higher layer."""
    module, _, function = place.partition(":")
    return getattr(import_module(module), function)


def _kind_of(thing: Any) -> str:
    if isinstance(thing, type):
        return f"the class {thing.__qualname__}"
    called = getattr(thing, "__qualname__", "") or getattr(thing, "__name__", "")
    return f"the {type(thing).__name__} {called}" if called else f"a {type(thing).__name__}"


def _exception_text(error: BaseException) -> str:
    try:
        return f"{type(error).__name__}: {error}"[:_LONGEST]
    except BaseException:  # str(error) may run code of the plugin
        return type(error).__name__


def _source(entry: EntryPoint) -> Source:
    owner = _owner(entry.dist) if entry.dist is not None else "an unknown distribution"
    return Source(entry.name, owner, entry.value)


@cache
def _owner(dist: Distribution) -> str:
    """Return name and version. Cached: each access parses the metadata again, which takes 1 ms."""
    return f"{dist.name} {dist.version}"


_CLASSES = "benchnav.navigation.plugin.contract"

NAVIGATORS = Registry("benchnav.navigators", "navigator", f"{_CLASSES}:navigator_rule")
PLANNERS = Registry("benchnav.planners", "planner", f"{_CLASSES}:planner_rule")
CONTROLLERS = Registry("benchnav.controllers", "controller", f"{_CLASSES}:controller_rule")
METRICS = Registry(
    "benchnav.metrics", "metric", "benchnav.metrics.contract:metric_rule",
    "benchnav.metrics.metric:metrics_in",
)  # fmt: skip
SCENARIOS = Registry("benchnav.scenarios", "scenario")  # packages of YAML files, as below
SUITES = Registry("benchnav.suites", "suite")
ROBOTS = Registry("benchnav.robots", "robot")
TRAINERS = Registry("benchnav.trainers", "trainer", "benchnav.envs.trainer:trainer_rule")

Registration = tuple[str, str, str]
"""(group, name, module:attribute)"""


def registrations() -> list[Registration]:
    """Return the registrations of this process, of all kinds of plugins that episodes need."""
    return [one for registry in _FOR_WORKERS for one in registry.registrations()]


def adopt(registrations: Iterable[Registration]) -> None:
    """Register the plugins of another process that can be imported here."""
    by_group = {registry.group: registry for registry in _FOR_WORKERS}
    for group, name, value in registrations:
        by_group[group].adopt(name, value)


_FOR_WORKERS = (NAVIGATORS, PLANNERS, CONTROLLERS, METRICS)

register_navigator = NAVIGATORS.register
register_planner = PLANNERS.register
register_controller = CONTROLLERS.register
register_metric = METRICS.register
