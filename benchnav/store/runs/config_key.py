"""The key `config` of scenarios and navigators in a manifest, called `says` before schema 6."""

from collections.abc import Mapping
from typing import Any

RENAMED_IN = 6  # the first schema with the key `config`
_KEY, _OLD_KEY = "config", "says"


def old_form(suite: Any) -> Any:
    """Return a resolved suite with the old key, for its hash and for manifests of old schemas."""
    return _renamed(suite, _KEY, _OLD_KEY)


def new_form(suite: Any) -> Any:
    """Return the resolved suite of an old manifest with the key `config`."""
    return _renamed(suite, _OLD_KEY, _KEY)


def _renamed(suite: Any, old: str, new: str) -> Any:
    if not isinstance(suite, Mapping):
        return suite  # of a damaged manifest
    entries = {
        name: [_renamed_in(entry, old, new) for entry in suite[name]]
        for name in ("scenarios", "navigators")
        if isinstance(suite.get(name), list | tuple)
    }
    return {**suite, **entries}


def _renamed_in(entry: Any, old: str, new: str) -> Any:
    """Return the entry with the renamed key; a damaged one that has both keys keeps both."""
    if not isinstance(entry, Mapping) or (old in entry and new in entry):
        return entry
    renamed = {new if key == old else key: value for key, value in entry.items()}
    if "leader" in entry:
        renamed["leader"] = _renamed_in(entry["leader"], old, new)
    return renamed
