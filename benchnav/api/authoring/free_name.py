"""Names for a new plugin package without conflicts with Python or installed packages."""

import builtins
import keyword
import re
import sys
from importlib.metadata import PackageNotFoundError, distribution, requires
from importlib.util import find_spec
from itertools import chain, count

from benchnav.plugins import NAVIGATORS, Registry


def module_name(name: str) -> str:
    """Return the name of the package's module."""
    return name.replace("-", "_")


def class_name(name: str) -> str:
    """Return the name of the plugin's class."""
    return "".join(part.capitalize() for part in name.split("-"))


def name_taken(name: str, registry: Registry = NAVIGATORS) -> str:
    """Return the owner of a plugin's name, as a sentence; "" if the name is free."""
    module = module_name(name)
    for each in {name, module} & {*registry.names()}:
        return f"{each!r} is a {registry.kind} of {registry.source(each).distribution}"
    for word in (module, class_name(name)):
        if keyword.iskeyword(word) or keyword.issoftkeyword(word):
            return f"{word!r} is a word of Python's grammar"
    if module in sys.stdlib_module_names or hasattr(builtins, module):
        return f"{module!r} is Python's own"
    if module in sys.modules or find_spec(module) is not None:
        return f"{module!r} is a module that is installed"
    if _is_distribution(name):
        return f"{name!r} is a package that is installed, or one that benchnav uses"
    return ""


def free_name(name: str, registry: Registry = NAVIGATORS) -> str:
    """Return a name like ``name`` that is free."""
    first = f"my-{name}"
    others = (f"{first}-{number}" for number in count(2))
    return next(each for each in chain((first,), others) if not name_taken(each, registry))


def _is_distribution(name: str) -> bool:
    used = {re.match(r"[\w.-]+", line) for line in requires("benchnav") or ()}
    if _plain(name) in {_plain(found[0]) for found in used if found}:
        return True
    try:
        distribution(name)
    except PackageNotFoundError:
        return False
    return True


def _plain(name: str) -> str:
    """Return the normalized name, by which package indexes compare names."""
    return re.sub(r"[-_.]+", "-", name).lower()
