"""The source hash of a navigator: of every file or notebook cell of its code and its parts."""

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from benchnav.source.closure import Closure
from benchnav.source.live import LiveSource
from benchnav.source.loaded import edited_since_import
from benchnav.source.module import INIT, Module, forget_listings
from benchnav.source.named_files import named_by_code, named_by_parameters
from benchnav.source.parts import live_object
from benchnav.source.tree import data_of, digest_of

SIZE = 16  # hexadecimal digits of a source hash


@dataclass(frozen=True)
class FoundSource:
    """The result of a search for a navigator's source."""

    hash: str  # equal on every machine and in every folder
    edited: tuple[str, ...]  # modules that were edited after this process imported them


def find_source(places: Iterable[str], specs: Iterable[Mapping[str, Any]] = ()) -> FoundSource:
    """Find the source at ``places`` and in the files that ``specs`` name, without importing it.

    Args:
        places: ``module:attribute`` of the classes of the navigator and its parts.
        specs: parameters; their strings may name programs, scripts, weights and folders.
    """
    forget_listings()
    places = sorted(set(places))
    lines = [f"place {place}" for place in places]
    closure, live = Closure(), LiveSource()
    for place in places:
        thing = live_object(place)
        if thing is None:
            closure.add([place.partition(":")[0]])
        else:
            live.add(thing, place)
    for spec in specs:
        named = named_by_parameters(spec)
        lines += [f"parameter {name} {digest_of(file)}" for name, file in named.files]
        closure.add(named.modules)
        for script in named.scripts:
            closure.add_file(script)
    closure.follow(live.imports)
    modules = {module.name: digest_of(module.file) for module in closure.modules.values()}
    lines += [*live.lines, *(f"module {name} {digest}" for name, digest in modules.items())]
    lines += _data(closure.modules.values())
    text = "\n".join(sorted(set(lines)))
    whole = hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()
    return FoundSource(whole[:SIZE], edited_since_import(modules))


def source_hash(places: Iterable[str], specs: Iterable[Mapping[str, Any]] = ()) -> str:
    """Return the hash of `find_source`."""
    return find_source(places, specs).hash


def _data(modules: Iterable[Module]) -> list[str]:
    """Return a line per data file of the modules and their packages."""
    lines = []
    for module in modules:
        if module.file.suffix == ".py":
            lines += [f"named {text} {digest_of(file)}" for text, file in named_by_code(module)]
        if module.file.name == INIT:
            folder = module.file.parent
            lines += [
                f"data {module.name}/{file.relative_to(folder).as_posix()} {digest_of(file)}"
                for file in data_of(folder)
            ]
    return lines
