"""All own modules of a navigator: its module, and the own modules that it imports in turn.

Own code is code in a working copy, or installed by the same distribution. Imports of libraries
and of the simulator are not followed: their versions represent them.
"""

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from benchnav.source.module import CORE, Module, installed_with, is_library, locate
from benchnav.source.syntax import imported, references
from benchnav.source.tree import files_below

MAX_MODULES = 5_000  # of a navigator


@dataclass
class Closure:
    """The modules by name; `add` extends them."""

    folders: tuple[str, ...] = ()  # searched before the import path
    modules: dict[str, Module] = field(default_factory=dict)
    _seen: set[str] = field(default_factory=set)
    _own_tops: set[str] = field(default_factory=set)  # top-level names that are own code
    _other_tops: set[str] = field(default_factory=lambda: {CORE})

    def add(self, names: Iterable[str]) -> None:
        """Add the named modules, which count as own code wherever they are, and their imports."""
        names = list(names)
        for top in {name.partition(".")[0] for name in names} - {CORE}:
            module = locate(top, self.folders)
            self._own_tops.add(top)
            if module is not None and is_library(module):
                self._own_tops |= installed_with(top) - {CORE}
        self.follow(names)

    def add_file(self, module: Module) -> None:
        """Add a script and its imports."""
        self.folders = (*self.folders, str(module.file.parent))
        self.modules[module.name] = module
        self._seen.add(module.name)
        self.follow(self._imports(module))

    def follow(self, names: Iterable[str]) -> None:
        """Add the named modules that are own code, and their imports."""
        pending = deque(names)
        while pending and len(self.modules) < MAX_MODULES:
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
        if top not in self._own_tops and top not in self._other_tops:
            module = locate(top, self.folders)
            own = module is not None and not is_library(module)
            (self._own_tops if own else self._other_tops).add(top)
        return top in self._own_tops

    def _imports(self, module: Module) -> Iterator[str]:
        if module.file.suffix != ".py":
            return
        found = references(module.file.read_bytes())
        yield from imported(found, module.package)
        if found.imports_by_text and module.package:
            yield from self._all_modules(module.name.partition(".")[0])

    def _all_modules(self, top: str) -> Iterator[str]:
        """Yield every module of a package: a computed import can name any of them."""
        package = locate(top, self.folders)
        if package is not None and package.is_package:
            for file in files_below(package.file.parent):
                if file.suffix == ".py":
                    parts = file.relative_to(package.file.parent).with_suffix("").parts
                    yield ".".join([top, *(p for p in parts if p != "__init__")])
