"""Compilation of this project's kernels, and the folder of the compiled code.

No fastmath: only correctly rounded operations may touch the state. No global interpreter lock, so
that threads can share rows. Division follows IEEE 754 (numpy's error model) instead of raising:
this saves a branch per division.

Numba notices a change of a cached kernel's own file, but not of a kernel that it calls in another
file, and would run the old code. Therefore the name of the cache folder is a digest of all kernel
sources of a package.

Numba takes half a second to import, and a kernel costs time to load. Therefore a kernel is loaded
or compiled when it is first called, and a process that calls none never imports Numba.
"""

import hashlib
import os
import shutil
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from functools import cached_property, lru_cache, update_wrapper
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar, cast

from benchnav.system.user_folders import UserFolder, user_cache

F = TypeVar("F", bound=Callable[..., Any])
_HERE = Path(__file__).parent
_CONSTANTS = ("arena", "episode")  # packages with enumerations that kernels compile in


class Kernel:
    """A function that Numba compiles when Python or another kernel first calls it."""

    def __init__(self, function: Callable[..., Any], **options: Any) -> None:
        update_wrapper(self, function)
        self.py_func = function
        self._options = options

    def __call__(self, *args: Any) -> Any:
        """Run the compiled code."""
        return self.for_python(*args)

    def __reduce__(self) -> str:
        """Pickle by name, as functions are."""
        return self.py_func.__qualname__

    @property
    def targetoptions(self) -> dict[str, Any]:
        """The options that Numba reads to inline a function."""
        return self._options

    @cached_property
    def for_python(self) -> Any:
        """The code that Python calls."""
        return self._dispatcher("")

    @cached_property
    def for_kernels(self) -> Any:
        """The code that other kernels call: a wrapper for Python would take time to compile."""
        return self._dispatcher("inner-", no_cpython_wrapper=True)

    def _dispatcher(self, prefix: str, **options: bool) -> Any:
        import numba

        from benchnav.kernel_cache import KernelCache

        _let_numba_call_kernels()
        function, njit = self.py_func, cast(Any, numba.njit)
        compiled = njit(
            function, error_model="numpy", no_cfunc_wrapper=True, **self._options, **options
        )
        folder = cache_folder(function.__module__.partition(".")[0])
        if folder is not None and Path(function.__code__.co_filename).is_file():
            compiled._cache = KernelCache(function, folder, prefix)
        return compiled


@lru_cache
def _let_numba_call_kernels() -> None:
    """Tell Numba that a kernel within a kernel is a function that it compiles."""
    from numba.core import types
    from numba.extending import typeof_impl

    from benchnav.system.blas_import import delay_blas

    delay_blas()

    @typeof_impl.register(Kernel)
    def _(value: Kernel, _: object) -> Any:
        return types.Dispatcher(value.for_kernels)


def kernel(function: F) -> F:
    """Compile once per signature, and cache on disk if there is a cache folder."""
    return cast(F, Kernel(function, nogil=True))


def kernel_without_allocation(function: F) -> F:
    """Compile a kernel that neither allocates nor returns arrays, nor calls a kernel that does.

    Numba counts the references to arrays with atomic instructions, at every access to a row or a
    record. This kernel counts none, and is up to twice as fast. Scratch arrays are arguments. An
    allocation is an error when it is compiled.
    """
    return cast(F, Kernel(function, nogil=True, _nrt=False))


def inlined(function: F) -> F:
    """Compile a part of a kernel that is inlined into its callers.

    For code that runs once per agent with many arrays: passing an array costs more than
    reading it.
    """
    return cast(F, Kernel(function, inline="always"))


@lru_cache
def kernels_name(package: str) -> str:
    """Return a digest name of the code from which a top-level package's kernels are compiled."""
    digest = hashlib.blake2b(version("numba").encode(), digest_size=8)
    source = getattr(sys.modules.get(package), "__file__", None)
    for root in sorted({_HERE, Path(source).parent if source else _HERE}):
        digest.update(_digest_of_kernels(root))
    return f"kernels-{digest.hexdigest()}"


@lru_cache
def _digest_of_kernels(root: Path) -> bytes:
    digest = hashlib.blake2b()
    for path in sorted(root.rglob("*.py")):
        text = path.read_bytes()
        if b"@kernel" in text or b"@inlined" in text or path.parent.name in _CONSTANTS:
            digest.update(text)
    return digest.digest()


@lru_cache
def cache_folder(package: str) -> Path | None:
    """Return the folder of a top-level package's compiled kernels; None if there is none."""
    base = cache_base().path
    if base is None:
        return None
    folder = base / kernels_name(package)
    if folder.is_dir():
        from benchnav.kernel_cache import drop_unfinished

        drop_unfinished(folder)
    else:
        _remove_old(base)
    return folder


def cache_base() -> UserFolder:
    """Return the folder of all compiled kernels: ``$NUMBA_CACHE_DIR``, or the user's cache."""
    from numba.core import config  # its value may come from a file of Numba

    requested = str(vars(config)["CACHE_DIR"])
    if not requested:
        return user_cache()
    base = Path(requested).absolute()
    try:
        base.mkdir(parents=True, exist_ok=True)
        if os.access(base, os.R_OK | os.W_OK | os.X_OK):
            return UserFolder(base)
        cause = "Permission denied"
    except OSError as error:
        cause = str(error.strerror)
    return UserFolder(user_cache().path, f"NUMBA_CACHE_DIR={requested} cannot be used ({cause})")


def compiled_since(moment: float) -> int:
    """Return how many kernels were put into the cache after ``moment`` [s since 1970]."""
    base = cache_base().path
    found = base.glob("kernels-*/*.kernel") if base is not None else ()
    times = (path.stat().st_mtime for path in found)
    try:
        return sum(time >= moment for time in times)
    except OSError:  # another process removes an old folder
        return 0


def _remove_old(base: Path) -> None:
    """Remove kernel folders that were not used for a month."""
    for folder in base.glob("kernels-*"):
        with suppress(OSError):  # another process removes it at the same time
            if time.time() - folder.stat().st_mtime > 30 * 86400:
                shutil.rmtree(folder, ignore_errors=True)
