"""Notices what a navigator replaces of the code that runs it, before that code runs again.

Within one process nothing can forbid this, and who first takes the guard away goes
unnoticed: it is for what is done by a line or two. `--isolate` keeps a navigator's code
out of the process altogether.
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
_ELSEWHERE = ("benchnav.", "pydantic")  # what is not there while an episode runs
_code = attrgetter("__code__")
_Space = tuple[Any, Mapping[str, Any], str]  # a module or class, what it holds, its name


class Guard:
    """The modules and classes that run episodes, and the code of their functions, as now."""

    def __init__(self) -> None:
        self._spaces = [*_spaces()]
        self._keep()
        found = {id(f): f for value in self._values for f in _functions(value)}
        self._functions = [*found.values()]
        self._code = [*map(_code, self._functions)]

    def replaced(self) -> str:
        """The name of what is no longer as it was; all is put back. "" where nothing changed."""
        changed: list[str] = []
        if not _same(self._values, self._now()):
            for (owner, held, whose), before in zip(self._spaces, self._held, strict=True):
                changed += _restored(owner, held, whose, before)
            self._keep()  # with what Python itself adds to a class when it is asked
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
        return [*chain.from_iterable([held.values() for _, held, _ in self._spaces])]


def _same(before: list[Any], now: list[Any]) -> bool:
    """The same objects. Lists look at identity first, and faster than anything else does."""
    try:
        return before == now
    except Exception:  # of what cannot be compared with what it replaced
        return False


def _restored(
    owner: Any, held: Mapping[str, Any], whose: str, before: dict[str, Any]
) -> Iterator[str]:
    """Put back what was replaced, take away what can be called and is new; yields their names."""
    for name, value in before.items():
        if held.get(name, before) is not value:
            setattr(owner, name, value)
            yield f"{whose}.{name}"
    for name in [name for name in held if name not in before]:
        shadows = isinstance(owner, type) or name in vars(builtins)
        if shadows and isinstance(held[name], FunctionType):
            delattr(owner, name)
            yield f"{whose}.{name}"


def _spaces() -> Iterator[_Space]:
    """The watched modules, and what they know of: their classes, and those of libraries."""
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
    """What is called where ``value`` is: itself, or what a property or class method calls."""
    if isinstance(value, property):
        value = value.fget
    elif isinstance(value, cached_property):
        value = value.func
    elif isinstance(value, (staticmethod, classmethod)):
        value = value.__func__
    if isinstance(value, FunctionType):
        yield value
