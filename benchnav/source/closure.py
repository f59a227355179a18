"""The modules that a navigator's code is made of: its own, and what these import of their own.

Own code is what a working copy holds, and what is installed by the same distribution.
Libraries are not followed, nor is the simulator: their versions stand for them.
"""

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from benchnav.source.module import CORE, Module, installed_with, is_library, locate
from benchnav.source.syntax import imported, references
from benchnav.source.tree import files_below

MOST_MODULES = 5_000  # of a navigator


@dataclass
class Closure:
    """Modules by name; grows by `add`."""

    folders: tuple[str, ...] = ()  # searched before the import path
    modules: dict[str, Module] = field(default_factory=dict)
    _seen: set[str] = field(default_factory=set)
    _tops: set[str] = field(default_factory=set)  # top-level names that are own code
    _other: set[str] = field(default_factory=lambda: {CORE})

    def add(self, names: Iterable[str]) -> None:
        """Add the modules called so, as own code wherever they are, and what they import."""
        names = list(names)
        for top in {name.partition(".")[0] for name in names} - {CORE}:
            module = locate(top, self.folders)
            self._tops.add(top)
            if module is not None and is_library(module):
                self._tops |= installed_with(top) - {CORE}
        self.follow(names)

    def add_file(self, module: Module) -> None:
        """Add a script, and what it imports."""
        self.folders = (*self.folders, str(module.file.parent))
        self.modules[module.name] = module
        self._seen.add(module.name)
        self.follow(self._imports(module))

    def follow(self, names: Iterable[str]) -> None:
        """Add those of the modules called so that are own code, and what they import."""
        pending = deque(names)
        while pending and len(self.modules) < MOST_MODULES:
            name = pending.popleft()
            if name in self._seen or not self._is_own(name.partition(".")[0]):
                continue
            self._seen.add(name)
            if "." in name:  # importing a module runs its packages first
                pending.append(name.rpartition(".")[0])
            module = locate(name, self.folders)
            if module is not None and module.file.is_file():
                self.modules[name] = module
                pending.extend(self._imports(module))

    def _is_own(self, top: str) -> bool:
        if top not in self._tops and top not in self._other:
            module = locate(top, self.folders)
            own = module is not None and not is_library(module)
            (self._tops if own else self._other).add(top)
        return top in self._tops

    def _imports(self, module: Module) -> Iterator[str]:
        if module.file.suffix != ".py":
            return
        found = references(module.file.read_bytes())
        yield from imported(found, module.package)
        if found.imports_by_text and module.package:
            yield from self._whole(module.name.partition(".")[0])

    def _whole(self, top: str) -> Iterator[str]:
        """Every module of a package: where imports are computed, each may be one of them."""
        package = locate(top, self.folders)
        if package is not None and package.is_package:
            for file in files_below(package.file.parent):
                if file.suffix == ".py":
                    parts = file.relative_to(package.file.parent).with_suffix("").parts
                    yield ".".join([top, *(p for p in parts if p != "__init__")])
