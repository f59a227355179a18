"""Whether another process can import a class or function of this one."""

import ast
import sys
from functools import lru_cache
from operator import attrgetter
from pathlib import Path
from typing import Any

from benchnav.source.module import locate

MAIN = "__main__"
_LOCAL = "<locals>"


def is_importable(thing: Any) -> bool:
    """Whether a worker process finds ``thing`` by its module and name.

    Workers import the script that started this process under another name, so they know its
    top-level definitions. They do not know the cells of a notebook.
    """
    module, name = getattr(thing, "__module__", None), getattr(thing, "__qualname__", "")
    if not module or not name or _LOCAL in name:
        return False
    if module == MAIN:
        script = getattr(sys.modules[MAIN], "__file__", None)
        return script is not None and name.partition(".")[0] in _defined_by(Path(script))
    try:
        found = attrgetter(name)(sys.modules[module])
    except (KeyError, AttributeError):
        return False
    place = locate(module)
    return found is thing and place is not None and place.file.is_file()


def _defined_by(script: Path) -> frozenset[str]:
    """Return the classes and functions that a script always defines at its top level."""
    try:
        return _defined(script.read_bytes())
    except OSError:
        return frozenset()


@lru_cache(16)
def _defined(code: bytes) -> frozenset[str]:
    try:
        body = ast.parse(code).body
    except (SyntaxError, ValueError):
        return frozenset()
    return frozenset(n.name for n in body if isinstance(n, ast.ClassDef | ast.FunctionDef))
