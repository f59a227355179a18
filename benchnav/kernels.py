"""How this project compiles its kernels, and where the compiled code is kept.

No fastmath: only correctly rounded operations may touch the state. No interpreter
lock, so that rows can be shared between threads. Division follows IEEE 754 (numpy's
error model) instead of raising: a branch less at every division.

Numba notices when a cached kernel's own file changes, but not when a kernel that it
calls does, in another file; it would go on running the old code. So the cache lives
in a folder named after everything that kernels of a package are made of.
"""

import getpass
import hashlib
import os
import shutil
import sys
import tempfile
import time
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
    settings = vars(config)
    theirs = settings["CACHE_DIR"]
    if not theirs:
        settings["CACHE_DIR"] = str(cache_folder(function.__module__.partition(".")[0]))
    compiled: F = njit(function, cache=True, nogil=True, error_model="numpy")
    settings["CACHE_DIR"] = theirs  # other packages keep their kernels where they did
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
    folder = _base() / f"kernels-{digest.hexdigest()}"
    if not folder.exists():
        _forget_old(folder.parent)
    return folder


def _base() -> Path:
    """The user's cache; or a folder of the user's own among the temporary files."""
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    existing = next(path for path in (home, *home.parents) if path.exists())
    if os.access(existing, os.W_OK):
        return home / "benchnav"
    base = Path(tempfile.gettempdir()) / f"benchnav-{getpass.getuser()}"
    base.mkdir(mode=0o700, exist_ok=True)
    return base


def _forget_old(base: Path) -> None:
    """Remove the kernels of states of the code that were not used for a month."""
    for folder in base.glob("kernels-*"):
        if time.time() - folder.stat().st_mtime > 30 * 86400:
            shutil.rmtree(folder, ignore_errors=True)
