"""How this project compiles its kernels, and where the compiled code is kept.

No fastmath: only correctly rounded operations may touch the state. No interpreter
lock, so that rows can be shared between threads. Division follows IEEE 754 (numpy's
error model) instead of raising, which halves the code that the compiler sees.

Numba notices when a cached kernel's own file changes, but not when a kernel that it
calls does, in another file; it would go on running the old code. So the cache lives
in a folder named after everything that kernels of a package are made of.
"""

import hashlib
import os
import sys
import tempfile
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba import njit
from numba.core import config

F = TypeVar("F", bound=Callable[..., Any])
_HERE = Path(__file__).parent
_CONSTANTS = ("arena", "episode")  # packages whose enumerations kernels freeze


def kernel(function: F) -> F:
    """Compile once per signature, cached on disk."""
    if not os.environ.get("NUMBA_CACHE_DIR"):
        vars(config)["CACHE_DIR"] = str(cache_folder(function.__module__.partition(".")[0]))
    compiled: F = njit(function, cache=True, nogil=True, error_model="numpy")
    return compiled


def inlined(function: F) -> F:
    """A part of a kernel, put into its callers before they are compiled.

    For what is called once per agent with many arrays: passing an array costs more than
    reading it.
    """
    compiled: F = njit(function, inline="always", error_model="numpy")
    return compiled


@lru_cache
def cache_folder(package: str) -> Path:
    """Where compiled kernels of a top-level package are kept: one folder per state of the code."""
    digest = hashlib.blake2b(numba.__version__.encode(), digest_size=8)
    source = getattr(sys.modules.get(package), "__file__", None)
    roots = {_HERE, Path(source).parent if source else _HERE}
    for root in sorted(roots):
        for path in sorted(root.rglob("*.py")):
            text = path.read_bytes()
            if b"@kernel" in text or b"@inlined" in text or path.parent.name in _CONSTANTS:
                digest.update(text)
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    writable = os.access(home if home.exists() else home.parent, os.W_OK)
    base = home if writable else Path(tempfile.gettempdir())
    return base / "benchnav" / f"kernels-{digest.hexdigest()}"
