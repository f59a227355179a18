"""The generator that a navigator is briefed with."""

import hashlib
import json

import numpy as np

_KEY = b"benchnav briefing 1"  # another key would be another stream for every episode


def generator(scenario_hash: str, split: str, seed: int, driver: int) -> np.random.Generator:
    """The one source of randomness of a navigator in one world.

    Seeded by a keyed hash, so that neither the generator nor its seed reveals the
    scenario, split or seed of the world, nor shares a stream with the draw of it.
    The same for every navigator and track: they are compared on the same luck.

    Args:
        scenario_hash: of the scenario.
        split: train, validation or test.
        seed: of the world.
        driver: 0 for the evaluated navigator, k > 0 for background driver k - 1.
    """
    message = json.dumps([scenario_hash, split, seed, driver]).encode()
    hashed = hashlib.blake2b(message, key=_KEY, digest_size=32).digest()
    entropy = int.from_bytes(hashed, "little")
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(entropy)))
