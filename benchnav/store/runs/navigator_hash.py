"""The hash of a navigator's configuration."""

import hashlib
import json
from collections.abc import Mapping
from typing import Any

from benchnav.store.runs.manifest import IN_PROCESS


def navigator_hash(
    spec: Mapping[str, Any], source: str, fingerprint: str = "", leader: str = "",
    mode: str = IN_PROCESS,
) -> str:  # fmt: skip
    """Return the hash of type, every parameter, distributions, files that it read, and mode.

    ``leader`` is the hash of the navigator that leads in its rehearsals; "" without one.
    Code does not count: it changes without a new version and has its own hash.
    """
    more = [part for part in (fingerprint, leader) if part]
    isolated = [] if mode == IN_PROCESS else [mode]
    text = json.dumps([dict(spec), source, *more, *isolated], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def hash_of_entry(entry: Mapping[str, Any]) -> str:
    """Return the hash of a navigator from its manifest entry."""
    leader = hash_of_entry(entry["leader"]) if "leader" in entry else ""
    return navigator_hash(
        entry["config"], str(entry["source"]), str(entry.get("fingerprint", "")), leader,
        str(entry.get("mode", IN_PROCESS)),
    )  # fmt: skip
