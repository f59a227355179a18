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
_SEALS = 0x1 | 0x2 | 0x4 | 0x10  # against: other seals, shrinking, growing, writing


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
            fcntl.fcntl(descriptor, fcntl.F_ADD_SEALS, _SEALS)
        except (AttributeError, OSError):
            os.close(descriptor)
            return None
        return cls(memory, descriptor)

    @property
    def offer(self) -> IntArray:
        """The descriptor and the size [bytes], as `hello` reports them."""
        return np.array([self.descriptor, len(self.memory)])

    def close_descriptor(self) -> None:
        """Close the descriptor, once the process has inherited it."""
        os.close(self.descriptor)


def open_offered(descriptor: int, size: int) -> memoryview | None:
    """Return the memory that the runner offers, and close its descriptor.

    Return None if the descriptor does not lead to it: a program between both, such as a
    container's, may not pass it on.
    """
    try:
        import fcntl

        seals = fcntl.fcntl(descriptor, fcntl.F_GET_SEALS)
        if seals != _SEALS or os.fstat(descriptor).st_size != size:
            return None
        memory = mmap.mmap(descriptor, size, prot=mmap.PROT_READ)
    except (ImportError, AttributeError, OSError):
        return None
    os.close(descriptor)
    return memoryview(memory)
