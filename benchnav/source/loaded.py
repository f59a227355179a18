"""Modules that this process imported, and that were edited since: it still runs the old code."""

import sys
from collections.abc import Mapping

_SEEN: dict[str, tuple[object, str]] = {}  # module → (its import, sha256 of the file it came from)


def edited_since_import(modules: Mapping[str, str]) -> tuple[str, ...]:
    """Return the names among ``modules`` (name → sha256 of the file now) that were edited.

    The first call after an import takes the file to be what was imported; reloading counts
    as an import.
    """
    edited = []
    for name, digest in modules.items():
        spec = getattr(sys.modules.get(name), "__spec__", None)
        if spec is None:
            continue
        if name not in _SEEN or _SEEN[name][0] is not spec:
            _SEEN[name] = spec, digest
        if _SEEN[name][1] != digest:
            edited.append(name)
    return tuple(sorted(edited))
