"""Python modules on disk, located without importing them or their packages."""

import sys
import sysconfig
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib import invalidate_caches
from importlib.machinery import ModuleSpec, PathFinder
from importlib.metadata import packages_distributions
from pathlib import Path

from benchnav.named_module import current_folder

CORE = "benchnav"  # represented by its version
INIT = "__init__.py"
_LIBRARIES = ("site-packages", "dist-packages")


@dataclass(frozen=True)
class Module:
    """A module, or the ``__init__`` of a package."""

    name: str  # as in an import statement: package.module
    file: Path
    is_package: bool

    @property
    def package(self) -> str:
        """The package from which relative imports start; "" for a module outside a package."""
        return self.name if self.is_package else self.name.rpartition(".")[0]

    @property
    def root(self) -> Path:
        """The folder that contains the top-level module or package."""
        return self.file.parents[self.name.count(".") + self.is_package]


def locate(name: str, folders: Sequence[str] = ()) -> Module | None:
    """Return the module ``name``; None if no file or folder has this name.

    ``folders`` are searched before the import path, the current folder after it, like
    `benchnav.named_module` does. For a package without ``__init__``, the returned file does not
    exist.
    """
    spec: ModuleSpec | None = None
    path: list[str] | None = None
    parts = name.split(".")
    for count in range(1, len(parts) + 1):
        spec = _spec(".".join(parts[:count]), path, folders)
        if spec is None:
            return None
        path = list(spec.submodule_search_locations or ())
        if count < len(parts) and not path:
            return None
    if spec is not None and spec.has_location and spec.origin is not None:
        file = Path(spec.origin)
        return Module(name, file, bool(path)) if file.is_file() else None
    return Module(name, Path(path[0], INIT), True) if path else None


def forget_listings() -> None:
    """Let `locate` see new files."""
    invalidate_caches()


def _spec(name: str, path: list[str] | None, folders: Sequence[str]) -> ModuleSpec | None:
    if path is None and folders:
        found = PathFinder.find_spec(name, list(folders))
        if found is not None and found.has_location:
            return found
    for finder in sys.meta_path:
        find = getattr(finder, "find_spec", None)
        try:
            spec: ModuleSpec | None = find(name, path) if find is not None else None
        except (ImportError, AttributeError, KeyError, ValueError):
            continue  # this finder needs the parent package to be imported
        if spec is not None:
            return spec
    return PathFinder.find_spec(name, [str(current_folder())]) if path is None else None


def is_library(module: Module) -> bool:
    """Whether a module is installed or part of Python, rather than in a working copy."""
    standard = (sysconfig.get_path("stdlib"), sysconfig.get_path("platstdlib"))
    if any(module.file.is_relative_to(folder) for folder in standard):
        return True
    root = module.root
    return root.name in _LIBRARIES or _holds_distributions(root)


@cache
def _holds_distributions(folder: Path) -> bool:
    return any(folder.glob("*.dist-info"))


@cache
def installed_with(top: str) -> frozenset[str]:
    """Return the top-level names that the distribution of ``top`` installs."""
    owners = packages_distributions()
    own = set(owners.get(top, ()))
    return frozenset(name for name, dists in owners.items() if own & set(dists))
