"""The generator of a briefing, made from a 32-byte hash that does not reveal its inputs."""

import hashlib
from typing import Any

import numpy as np
from numpy.random.bit_generator import ISpawnableSeedSequence

from benchnav.arrays import AnyArray

SIZE = 32  # bytes


class HashedSeeds(ISpawnableSeedSequence):
    """A seed sequence made from a hash; it does not hold the inputs of the hash."""

    def __init__(self, hashed: bytes) -> None:
        self._hashed = hashed
        self._spawned = 0

    def generate_state(self, n_words: int, dtype: Any = np.uint32) -> AnyArray:
        """Return (n_words,) words of state, as numpy requires."""
        kind = np.dtype(dtype)
        stream = hashlib.shake_256(b"state" + self._hashed).digest(n_words * kind.itemsize)
        return np.frombuffer(stream, kind.newbyteorder("<")).astype(kind)

    def spawn(self, n_children: int) -> list["HashedSeeds"]:
        """Return new sequences, independent of this one and of all spawned before."""
        first, self._spawned = self._spawned, self._spawned + n_children
        return [
            HashedSeeds(hashlib.sha256(f"child {k} ".encode() + self._hashed).digest())
            for k in range(first, self._spawned)
        ]

    @property
    def fresh(self) -> bytes | None:
        """The bytes that it was made from; None after something was spawned from it."""
        return None if self._spawned else self._hashed


def hashed_generator(hashed: bytes) -> np.random.Generator:
    """Return the generator that is seeded with `SIZE` bytes."""
    seeds: Any = HashedSeeds(hashed)  # numpy takes every ISeedSequence; its stubs accept only one
    return np.random.Generator(np.random.PCG64(seeds))


def seed_bytes(rng: np.random.Generator) -> bytes:
    """Return `SIZE` bytes from which `hashed_generator` makes an equivalent of ``rng``.

    They are the seed of an unused generator; a used or foreign generator draws them.
    """
    seeds = rng.bit_generator.seed_seq
    made_from = seeds.fresh if isinstance(seeds, HashedSeeds) else None
    if made_from is not None:
        untouched = hashed_generator(made_from).bit_generator.state
        if rng.bit_generator.state == untouched:
            return made_from
    return rng.bytes(SIZE)
