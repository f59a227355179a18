"""The source of objects without a file: a cell of a notebook, a local function of a script.

A function counts by its text, or by its bytecode if the text is unknown. Its defaults, closure,
and the functions, classes and constants of the same session that it uses count too.
"""

import dis
import hashlib
import inspect
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, is_dataclass
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from benchnav.source.importable import MAIN, is_importable
from benchnav.source.module import CORE, is_library, locate

_PLAIN = (type(None), bool, int, float, complex, str, bytes, type(...))
_WRAPPED = ("__func__", "fget", "fset", "func", "py_func", "__wrapped__")
_MAX_DEPTH = 12
_HEAP_TYPE = 1 << 9  # Py_TPFLAGS_HEAPTYPE: a class that Python code created


@dataclass
class LiveSource:
    """The source of live objects; `add` extends it."""

    lines: list[str] = field(default_factory=list)
    imports: set[str] = field(default_factory=set)  # modules whose files count as well
    _seen: dict[int, Any] = field(default_factory=dict)

    def add(self, thing: Any, path: str, depth: int = 0) -> None:
        """Describe ``thing``, found at ``path``, and everything that it uses."""
        if isinstance(thing, _PLAIN):
            self.lines.append(f"{path} = {thing!r}")
        elif depth <= _MAX_DEPTH and id(thing) not in self._seen:
            self._seen[id(thing)] = thing
            for name, part in self._parts(thing, path):
                self.add(part, f"{path}.{name}", depth + 1)

    def _parts(self, thing: Any, path: str) -> Iterator[tuple[str, Any]]:
        """Yield the parts of ``thing``; also append its own line."""
        if isinstance(thing, ModuleType):
            self.imports.add(thing.__name__)
        elif isinstance(thing, FunctionType | type):
            if _is_live(thing):
                yield from (
                    self._function(thing, path)
                    if isinstance(thing, FunctionType)
                    else self._class(thing, path)
                )
            else:
                self.lines.append(f"{path} is {thing.__module__}.{thing.__qualname__}")
                self.imports.add(thing.__module__)
        elif isinstance(thing, Mapping):
            for key in sorted(thing, key=repr):
                yield repr(key), thing[key]
        elif isinstance(thing, list | tuple):
            yield from ((str(i), item) for i, item in enumerate(thing))
        elif isinstance(thing, set | frozenset):
            yield from ((str(i), item) for i, item in enumerate(sorted(thing, key=repr)))
        elif isinstance(thing, np.ndarray | np.generic):
            data = np.ascontiguousarray(thing)
            digest = hashlib.sha256(data.tobytes()).hexdigest()
            self.lines.append(f"{path} = {data.dtype} {data.shape} {digest}")
        else:
            yield from self._object(thing, path)

    def _object(self, thing: Any, path: str) -> Iterator[tuple[str, Any]]:
        kind = type(thing)
        self.lines.append(f"{path} is a {kind.__module__}.{kind.__qualname__}")
        wrapped = [(n, getattr(thing, n, None)) for n in _WRAPPED]
        if any(inner is not None for _, inner in wrapped):  # a property, a decorated function
            yield from wrapped
            yield from ((n, getattr(thing, n, None)) for n in ("args", "keywords"))
        elif _is_live(kind) or is_dataclass(thing):
            yield "type", kind
            yield from sorted(getattr(thing, "__dict__", {}).items())

    def _class(self, kind: type, path: str) -> Iterator[tuple[str, Any]]:
        self.lines.append(f"{path} is the class {kind.__qualname__}")
        yield from ((f"base {i}", base) for i, base in enumerate(kind.__bases__))
        for name, part in sorted(vars(kind).items()):
            method = isinstance(part, FunctionType | staticmethod | classmethod)
            if name != "_abc_impl" and (method or not name.startswith("__")):
                yield name, part

    def _function(self, function: FunctionType, path: str) -> Iterator[tuple[str, Any]]:
        self.lines.append(f"{path}: {_text(function)}")
        yield "defaults", function.__defaults__
        yield "keyword defaults", function.__kwdefaults__
        for name, cell in zip(
            function.__code__.co_freevars, function.__closure__ or (), strict=False
        ):
            if name != "__class__":
                yield name, _content(cell)
        for name in sorted(_globals_of(function.__code__)):
            if name in function.__globals__:
                yield name, function.__globals__[name]


def _is_live(thing: Any) -> bool:
    """Whether a function or class was defined in this session, and not in a file of its own."""
    module = str(getattr(thing, "__module__", None) or "builtins")
    if module == MAIN:
        return True
    if isinstance(thing, type) and not thing.__flags__ & _HEAP_TYPE:
        return False
    top = module.partition(".")[0]
    if top == CORE or (top in sys.stdlib_module_names and top != "builtins"):
        return False
    place = locate(module)
    return not is_importable(thing) and (place is None or not is_library(place))


def _text(function: FunctionType) -> str:
    try:
        return inspect.getsource(function)
    except (OSError, TypeError, SyntaxError, IndexError):
        return repr(_bytecode(function.__code__))


def _bytecode(code: CodeType) -> tuple[Any, ...]:
    """Return the operations of a code object, without its location."""
    constants = tuple(
        _bytecode(c) if isinstance(c, CodeType)
        else sorted(map(repr, c)) if isinstance(c, frozenset) else repr(c)
        for c in code.co_consts
    )  # fmt: skip
    return code.co_code.hex(), constants, code.co_names, code.co_varnames, code.co_freevars


def _globals_of(code: CodeType) -> set[str]:
    """Return the names of the globals that a function and its inner functions read."""
    found = {
        str(i.argval)
        for i in dis.get_instructions(code)
        if i.opname in ("LOAD_GLOBAL", "LOAD_NAME")
    }
    inner = (c for c in code.co_consts if isinstance(c, CodeType))
    return found.union(*map(_globals_of, inner))


def _content(cell: Any) -> Any:
    try:
        return cell.cell_contents
    except ValueError:  # not filled yet
        return None
