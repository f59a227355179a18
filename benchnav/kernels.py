"""How this project compiles its kernels.

No fastmath: only correctly rounded operations may touch the state. No interpreter
lock, so that rows can be shared between threads. Division follows IEEE 754 (numpy's
error model) instead of raising, which halves the code that the compiler sees.
"""

from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit

F = TypeVar("F", bound=Callable[..., Any])


def kernel(function: F) -> F:
    """Compile once per signature, cached on disk."""
    compiled: F = njit(function, cache=True, nogil=True, error_model="numpy")
    return compiled
