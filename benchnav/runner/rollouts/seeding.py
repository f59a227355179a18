"""The random generator of a navigator, the key of its noise, and the order of its worlds.

All follow from a salt, which is drawn for each run, stored in its manifest and given to no
navigator. Code that knows only the public rules therefore cannot find scenario, split and seed by
trying which of them gives the same generator. This protects only the generator: code that reads
the run folder or the memory of its process learns the salt, and a world that occurs again is
recognised by its starts and goals.
"""

import hashlib
import json
import re
import secrets

import numpy as np

from benchnav.arrays import AnyArray
from benchnav.navigation.randomness.briefing_seed import hashed_generator

_SALT = re.compile(r"(?:[0-9a-f]{2}){1,64}")  # the key of blake2b has at most 64 bytes


def draw_salt() -> str:
    """Return a new salt: 128 random bits of the system, in hexadecimal digits."""
    return secrets.token_hex(16)


def check_salt(salt: str) -> None:
    """Raise ValueError with the rule and the text if ``salt`` is invalid."""
    if not _SALT.fullmatch(salt):
        raise ValueError(f"must be 1 to 64 bytes in digits 0-9 a-f; got {salt[:140]!r}")


def generator(
    salt: str, scenario_hash: str, split: str, seed: int, driver: int, rehearsal: int = 0
) -> np.random.Generator:
    """Return the random generator of a navigator in one world.

    Within a run it is the same for every navigator and track (common random numbers), every batch
    and every number of workers. It is independent of the draw of the world.

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
    """Return the generator of the movers' phases in the k-th rehearsal, equal for all entries."""
    return hashed_generator(_hashed(salt, "phases", scenario_hash, split, seed, rehearsal))


def noise_key(salt: str, scenario_hash: str, split: str, seed: int, rehearsal: int = 0) -> AnyArray:
    """Return the key (2,) of uint64 of the noise of the senses in one world.

    Within a run it is the same for every navigator and track, so that all meet the same noise.
    """
    which = (rehearsal,) if rehearsal else ()
    words = np.frombuffer(_hashed(salt, "noise", scenario_hash, split, seed, *which), "<u8")[:2]
    return words.astype(np.uint64)


def place(salt: str, scenario_hash: str, split: str, seed: int) -> bytes:
    """Return a key: the order of worlds by this key does not depend on the order of their seeds."""
    return _hashed(salt, "place", scenario_hash, split, seed)


def _hashed(salt: str, *about: str | int) -> bytes:
    message = json.dumps(about).encode()
    return hashlib.blake2b(message, key=bytes.fromhex(salt), digest_size=32).digest()
