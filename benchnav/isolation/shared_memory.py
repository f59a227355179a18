"""Memory that the runner writes and a navigator's process may only read.

The fields of large requests lie in it, so that they need not pass through the pipe. The kernel
refuses every other writer and every change of its size (`F_SEAL_FUTURE_WRITE`, `F_SEAL_SHRINK`,
`F_SEAL_GROW`; Linux 5.1 or later), whatever the process does with the descriptor. The runner never
reads it.
"""

import mmap
import os
from dataclasses import dataclass
from typing import Self

import numpy as np

from benchnav.arrays import IntArray

SIZE = 1 << 26  # bytes; pages that no request reaches take no memory
_SEAL_SEAL, _SEAL_SHRINK, _SEAL_GROW, _SEAL_FUTURE_WRITE = 0x1, 0x2, 0x4, 0x10


@dataclass(frozen=True, eq=False)
class SharedMemory:
    """The memory, as the runner holds it, and a descriptor for the process."""

    memory: mmap.mmap
    descriptor: int

    @classmethod
    def create(cls) -> Self | None:
        """Return new memory, or None where the system offers none that can be sealed."""
        try:
            import fcntl

            descriptor = os.memfd_create("requests", os.MFD_ALLOW_SEALING | os.MFD_CLOEXEC)
        except (ImportError, AttributeError, OSError):
            return None
        try:
            os.ftruncate(descriptor, SIZE)
            memory = mmap.mmap(descriptor, SIZE)
            seals = _SEAL_SEAL | _SEAL_SHRINK | _SEAL_GROW | _SEAL_FUTURE_WRITE
            fcntl.fcntl(descriptor, fcntl.F_ADD_SEALS, seals)
        except (AttributeError, OSError):
            os.close(descriptor)
            return None
        return cls(memory, descriptor)

    @property
    def offer(self) -> IntArray:
        """Its descriptor and its size [bytes], as the process is informed of them."""
        return np.array([self.descriptor, SIZE])

    def close_descriptor(self) -> None:
        """Close the descriptor, once the process has its own."""
        os.close(self.descriptor)


def map_readable(descriptor: int, size: int) -> memoryview:
    """Return the memory behind a descriptor that the runner gave, and close the descriptor."""
    try:
        return memoryview(mmap.mmap(descriptor, size, prot=mmap.PROT_READ))
    finally:
        os.close(descriptor)
