"""The seal of a part: size and sha256 of each of its files, and its number of episodes."""

import re
from typing import Any

from benchnav.config.document import shown
from benchnav.store.runs import checked_json

SEAL = ".seal.json"
EPISODES_FILE = ".episodes.parquet"
RESULTS_FILE = ".results.parquet"
REHEARSALS_FILE = ".rehearsals.parquet"  # only if there were rehearsals
FILES = (EPISODES_FILE, RESULTS_FILE, REHEARSALS_FILE)
MAX_SEAL = 64 << 10  # bytes
_SHA256 = re.compile(r"[0-9a-f]{64}")
_MAX_SIZE = 1 << 62  # [bytes]
Facts = dict[str, Any]
"""``{"bytes": size, "sha256": hexadecimal digits}``"""


def require_facts(name: str, facts: object) -> Facts:
    """Return the size and sha256 of the file ``name`` from a seal or an index.

    Raises ValueError if ``facts`` are not that.
    """
    if not isinstance(facts, dict) or set(facts) != {"bytes", "sha256"}:
        raise ValueError(f"{name} must have the keys bytes and sha256; got {shown(facts)}")
    size, sha256 = facts["bytes"], facts["sha256"]
    if type(size) is not int or not 0 <= size < _MAX_SIZE:
        raise ValueError(f"{name}.bytes must be a size; got {shown(size)}")
    if not isinstance(sha256, str) or _SHA256.fullmatch(sha256) is None:
        raise ValueError(f"{name}.sha256 must be 64 digits 0-9 a-f; got {shown(sha256)!r}")
    return facts


def read_seal(text: str, episodes: int) -> dict[str, Facts]:
    """Return the facts on its files from the seal of a part of ``episodes`` episodes.

    Raises ValueError if the text is not such a seal.
    """
    fields = checked_json.load(text)
    held = fields.pop("episodes", None)
    if strange := [name for name in fields if name not in FILES]:
        raise ValueError(f"it has the unknown key {shown(strange[0])!r}")
    if missing := [name for name in (EPISODES_FILE, RESULTS_FILE) if name not in fields]:
        raise ValueError(f"it must have the key {missing[0]!r}; it is missing")
    if type(held) is not int or held != episodes:
        raise ValueError(f"it is of {shown(held)} episodes, and its name is of {episodes}")
    return {name: require_facts(name, facts) for name, facts in fields.items()}
