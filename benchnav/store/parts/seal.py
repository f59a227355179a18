"""The seal of a part: size and sha256 of each of its files, and how many episodes it holds."""

import re
from typing import Any

from benchnav.config.document import shown
from benchnav.store.runs import checked_json

SEAL = ".seal.json"
EPISODES_FILE = ".episodes.parquet"
RESULTS_FILE = ".results.parquet"
REHEARSALS_FILE = ".rehearsals.parquet"  # only where there were rehearsals
FILES = (EPISODES_FILE, RESULTS_FILE, REHEARSALS_FILE)
MOST_SEAL = 64 << 10  # bytes
_SHA256 = re.compile(r"[0-9a-f]{64}")
_MOST_SIZE = 1 << 62  # [bytes]
Facts = dict[str, Any]
"""``{"bytes": size, "sha256": hexadecimal digits}``"""


def require_facts(name: str, facts: object) -> Facts:
    """Return what a seal or an index says of the file ``name``.

    Raises ValueError where that is not its size and sha256.
    """
    if not isinstance(facts, dict) or set(facts) != {"bytes", "sha256"}:
        raise ValueError(f"{name} must have the keys bytes and sha256; got {shown(facts)}")
    size, sha256 = facts["bytes"], facts["sha256"]
    if type(size) is not int or not 0 <= size < _MOST_SIZE:
        raise ValueError(f"{name}.bytes must be a size; got {shown(size)}")
    if not isinstance(sha256, str) or _SHA256.fullmatch(sha256) is None:
        raise ValueError(f"{name}.sha256 must be 64 digits 0-9 a-f; got {shown(sha256)!r}")
    return facts


def read_seal(text: str, episodes: int) -> dict[str, Facts]:
    """Return what the seal of a part of so many episodes says of its files.

    Raises ValueError where the text is no such seal.
    """
    fields = checked_json.load(text)
    held = fields.pop("episodes", None)
    if strange := [name for name in fields if name not in FILES]:
        raise ValueError(f"it has the key {shown(strange[0])!r}, which no seal has")
    if missing := [name for name in (EPISODES_FILE, RESULTS_FILE) if name not in fields]:
        raise ValueError(f"it must have the key {missing[0]!r}, and has not")
    if type(held) is not int or held != episodes:
        raise ValueError(f"it is of {shown(held)} episodes, and its name is of {episodes}")
    return {name: require_facts(name, facts) for name, facts in fields.items()}
