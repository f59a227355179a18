"""Detects functions of benchnav that a navigator replaced, before they run again.

One process cannot prevent this, and a navigator that first disables the guard is not detected:
the guard is for simple replacements. `--isolate` keeps the code of a navigator out of the process.
"""

import builtins
import sys
from collections.abc import Iterator, Mapping
from functools import cached_property
from itertools import chain
from operator import attrgetter
from types import FunctionType
from typing import Any

import numpy as np

_WATCHED = (
    "arena", "episode", "generation", "kernels", "navigation", "runner", "sensors", "threads",
    "world",
)  # fmt: skip
_ELSEWHERE = ("benchnav.", "pydantic")  # prefixes of modules that no running episode needs
_code = attrgetter("__code__")
_Space = tuple[Any, Mapping[str, Any], str]  # a module or class, its attributes, its name


class Guard:
    """A snapshot of the modules and classes that run episodes, and of the code of functions."""

    def __init__(self) -> None:
        self._spaces = [*_spaces()]
        self._views = [held.values() for _, held, _ in self._spaces]  # they show later changes
        self._keep()
        found = {id(f): f for value in self._values for f in _functions(value)}
        self._functions = [*found.values()]
        self._code = [*map(_code, self._functions)]

    def replaced(self) -> str:
        """Return the name of a replaced object, or ""; all replaced objects are restored."""
        changed: list[str] = []
        if not _same(self._values, self._now()):
            for (owner, held, owner_name), before in zip(self._spaces, self._held, strict=True):
                changed += _restored(owner, held, owner_name, before)
            self._keep()  # Python itself adds attributes to classes on access
        if not _same(self._code, [*map(_code, self._functions)]):
            for function, code in zip(self._functions, self._code, strict=True):
                if function.__code__ is not code:
                    function.__code__ = code
                    changed.append(f"{function.__module__}.{function.__qualname__}")
        return changed[0] if changed else ""

    def _keep(self) -> None:
        self._held = [dict(held) for _, held, _ in self._spaces]
        self._values = self._now()

    def _now(self) -> list[Any]:
        return [*chain.from_iterable(self._views)]


def _same(before: list[Any], now: list[Any]) -> bool:
    """Whether the objects are the same. Comparison of lists tests identity first, and is fast."""
    try:
        return before == now
    except Exception:  # an object may not be comparable with its replacement
        return False


def _restored(
    owner: Any, held: Mapping[str, Any], owner_name: str, before: dict[str, Any]
) -> Iterator[str]:
    """Restore replaced attributes and delete added functions; yield their names."""
    for name, value in before.items():
        if held.get(name, before) is not value:
            setattr(owner, name, value)
            yield f"{owner_name}.{name}"
    for name in [name for name in held if name not in before]:
        shadows = isinstance(owner, type) or name in vars(builtins)
        if shadows and isinstance(held[name], FunctionType):
            delattr(owner, name)
            yield f"{owner_name}.{name}"


def _spaces() -> Iterator[_Space]:
    """Yield the watched modules, their classes, and the library classes that they use."""
    modules = [module for name, module in sys.modules.items() if _is_watched(name)]
    for module in (*modules, builtins, np):
        yield module, vars(module), module.__name__
    classes = {id(v): v for m in modules for v in vars(m).values() if isinstance(v, type)}
    for kind in classes.values():
        if _is_watched(kind.__module__) or not kind.__module__.startswith(_ELSEWHERE):
            yield kind, vars(kind), f"{kind.__module__}.{kind.__qualname__}"


def _is_watched(module: str) -> bool:
    package, _, rest = module.partition(".")
    return package == "benchnav" and rest.partition(".")[0] in _WATCHED


def _functions(value: Any) -> Iterator[FunctionType]:
    """Yield the function that ``value`` calls: itself, or that of a property or class method."""
    if isinstance(value, property):
        value = value.fget
    elif isinstance(value, cached_property):
        value = value.func
    elif isinstance(value, (staticmethod, classmethod)):
        value = value.__func__
    if isinstance(value, FunctionType):
        yield value
