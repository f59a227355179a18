"""The generator that a navigator is briefed with, and the order in which it meets worlds.

Both follow from a salt that is drawn for each run, stands in the run's manifest and is
handed to no navigator. Who knows the public rules alone can therefore not try scenarios,
splits and seeds until one fits what it was handed. This guards against what is handed
over, and no more: code that reads the run folder or the memory of its process learns the
salt, and the same world is recognised by its starts and goals whenever it is met again.
"""

import hashlib
import json
import re
import secrets

import numpy as np

from benchnav.navigation.randomness.briefing_seed import hashed_generator

_SALT = re.compile(r"(?:[0-9a-f]{2}){1,64}")  # the key of blake2b has at most 64 bytes


def draw_salt() -> str:
    """A new salt: 128 bits of the system's randomness, in hexadecimal digits."""
    return secrets.token_hex(16)


def check_salt(salt: str) -> None:
    """Raise ValueError, with the rule and what came instead, where ``salt`` is none."""
    if not _SALT.fullmatch(salt):
        raise ValueError(f"must be 1 to 64 bytes in digits 0-9 a-f; got {salt[:140]!r}")


def generator(
    salt: str, scenario_hash: str, split: str, seed: int, driver: int, rehearsal: int = 0
) -> np.random.Generator:
    """The one source of randomness of a navigator in one world.

    Within a run it is the same for every navigator and track (they are compared on the
    same luck), every batch and number of workers. It shares no stream with the draw of
    the world.

    Args:
        salt: of the run.
        scenario_hash: of the scenario.
        split: train, validation or test.
        seed: of the world.
        driver: 0 for the evaluated navigator, k > 0 for background driver k - 1.
        rehearsal: k in the k-th rehearsal, 0 in the scored episode.
    """
    which = (rehearsal,) if rehearsal else ()
    return hashed_generator(_hashed(salt, "stream", scenario_hash, split, seed, driver, *which))


def phases(
    salt: str, scenario_hash: str, split: str, seed: int, rehearsal: int
) -> np.random.Generator:
    """What the movers' phases in the k-th rehearsal are drawn from: alike for every entry."""
    return hashed_generator(_hashed(salt, "phases", scenario_hash, split, seed, rehearsal))


def place(salt: str, scenario_hash: str, split: str, seed: int) -> bytes:
    """Worlds sorted by this stand in an order that tells nothing about their seeds."""
    return _hashed(salt, "place", scenario_hash, split, seed)


def _hashed(salt: str, *about: str | int) -> bytes:
    message = json.dumps(about).encode()
    return hashlib.blake2b(message, key=bytes.fromhex(salt), digest_size=32).digest()
