"""Resolve ``module:attribute``, in installed modules and in modules of the current folder."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import reduce
from importlib import import_module, invalidate_caches
from pathlib import Path
from types import ModuleType
from typing import Any

from benchnav.errors import PluginError, did_you_mean

_stand_in = ""  # a folder to use instead of the current one; "" for none


def load_by_module(name: str) -> Any:
    """Return the object ``module:attribute``; the module may lie in the current folder.

    Raises PluginError if there is no such module or attribute, and any error of the import.
    """
    module, _, attribute = name.partition(":")
    if not (module and attribute):
        raise PluginError("it must be a plugin name, or module:Class.")
    if module.endswith(".py") or not all(module.split(".")) or os.sep in module:
        plain = Path(module.removesuffix(".py")).name
        raise PluginError(f"write a module without folder and ending: {plain}:{attribute}.")
    with current_folder_importable():
        try:
            found = import_module(module)
        except ModuleNotFoundError as error:
            if error.name and f"{module}.".startswith(f"{error.name}."):
                raise PluginError(_no_module(module, attribute)) from None
            raise
    try:
        return reduce(getattr, attribute.split("."), found)
    except AttributeError:
        raise PluginError(_no_attribute(found, attribute)) from None


@contextmanager
def current_folder_importable() -> Iterator[None]:
    """Make modules of the current folder importable inside this context.

    The folder comes last, so that no file in it shadows a standard or installed module.
    """
    folder = str(current_folder())
    if folder in sys.path:
        yield
        return
    sys.path.append(folder)
    invalidate_caches()
    try:
        yield
    finally:
        with suppress(ValueError):
            sys.path.remove(folder)


def search_in(folder: str) -> None:
    """Use ``folder`` as the current folder: this process works for another one started there."""
    global _stand_in
    _stand_in = folder


def current_folder() -> Path:
    """Return the folder that is searched for modules after all others."""
    with suppress(OSError):  # the current folder may have been removed
        return Path(_stand_in) if _stand_in else Path.cwd()
    return Path()


def _no_module(module: str, attribute: str) -> str:
    folder, first = current_folder(), module.partition(".")[0]
    near = did_you_mean(first, [path.stem for path in folder.glob("*.py")])
    return (
        f"no module {module!r} is installed or lies in {folder}.{near} Start benchnav in the"
        f" folder of {first}.py, or add that folder to PYTHONPATH."
    )


def _no_attribute(module: ModuleType, attribute: str) -> str:
    file = getattr(module, "__file__", None) or "it is built in"
    hidden = current_folder() / f"{module.__name__}.py"
    rename = (
        f" {hidden} is not read, because an installed module has its name: rename it."
        if hidden.is_file() and str(hidden) != file
        else ""
    )
    near = did_you_mean(attribute, vars(module))
    return f"the module {module.__name__} ({file}) has no {attribute!r}.{near}{rename}"
