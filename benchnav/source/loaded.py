"""Modules that were edited after this process imported them: it still runs the old code."""

import sys
from collections.abc import Mapping

_SEEN: dict[str, tuple[object, str]] = {}  # module → (its spec, sha256 of its file at import)


def edited_since_import(modules: Mapping[str, str]) -> tuple[str, ...]:
    """Return the edited modules among ``modules`` (name → sha256 of the file now), sorted.

    The first call after an import assumes that the file is unchanged since; a reload counts
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
