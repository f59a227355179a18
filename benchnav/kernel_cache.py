"""The on-disk cache of compiled kernels: one checked file per signature.

Numba's own index loses entries if several processes compile at once, raises on a damaged file,
and runs machine code with a flipped bit. Here each file begins with the sha256 of the rest and
holds its complete key. A file that fails this check is compiled again and replaced.
"""

import hashlib
import os
import pickle
import shutil
import tempfile
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any

import numba
from llvmlite.binding import parse_assembly
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.runtime.nrt import rtsys
from numba.core.serialize import dumps

SUFFIX = ".kernel"
_TEMPORARY = ".writing-"
_SUM = hashlib.sha256().digest_size
_STALE = 3600.0  # [s] age at which an unfinished file belongs to a killed process


class KernelCache(FunctionCache):
    """The cached signatures of one function."""

    def __init__(self, function: Callable[..., Any], folder: Path, prefix: str = "") -> None:
        self._name = repr(function)
        self._py_func = function
        self._impl = _Codec(is_linked=bool(prefix))
        self._cache_path = str(folder)
        name = f"{prefix}{function.__module__}.{function.__qualname__}"
        name = name.replace("<", "").replace(">", "")
        self._cache_file: Any = _Files(folder, name)
        self.enable()

    def load_overload(self, signature: Any, target: Any) -> Any:
        """Return the compiled code; None if it must be compiled.

        Loading needs Numba's runtime only. Numba would also read its registries of functions again
        for each kernel; it does so anyway before it compiles one.
        """
        try:
            rtsys.initialize(target)
            return self._load_overload(signature, target)
        except Exception:  # an intact file that this Numba cannot use, such as one of another build
            return None

    def save_overload(self, signature: Any, compiled: Any) -> None:
        """Save the compiled code if it can be cached."""
        if self._enabled and self._impl.check_cachable(compiled):
            key = self._index_key(signature, compiled.codegen)
            self._cache_file.save(key, self._impl.reduce(compiled))

    def _index_key(self, signature: Any, codegen: Any) -> Any:
        source = _digest_of(self._py_func.__code__.co_filename)
        return (*super()._index_key(signature, codegen), source)


class _Codec(CompileResultCacheImpl):
    """Converts a compiled function to the data that Numba stores.

    Numba stores machine code, and LLVM code that is linked into callers; to parse the latter takes
    more time than all else. For a function that only Python calls, the names are enough.
    """

    def __init__(self, is_linked: bool) -> None:
        """Skip Numba's search by source location: `_Files` finds the files."""
        self._is_linked = is_linked

    def reduce(self, compiled: Any) -> Any:
        """Return the data to store."""
        library, function, *rest = super().reduce(compiled)
        if not self._is_linked:
            name, kind, (machine_code, _) = library
            names = function.llvm_func_name, function.llvm_cpython_wrapper_name
            library = name, kind, (machine_code, _module_of(names))
        return library, function, *rest

    def check_cachable(self, compiled: Any) -> bool:
        """Whether another process can use the compiled code."""
        whole = all(part.can_cache for part in compiled.lifted)
        return whole and not compiled.library.has_dynamic_globals


def _module_of(names: Iterable[str]) -> bytes:
    """Return LLVM code that defines these names, and nothing else."""
    lines = (f'define void @"{name}"() {{ ret void }}' for name in names)
    code: bytes = parse_assembly("\n".join(lines)).as_bitcode()
    return code


@lru_cache
def _digest_of(source: str) -> str:
    """Return the sha256 of a source file, as Numba's key ignores the constants of a function."""
    return hashlib.sha256(Path(source).read_bytes()).hexdigest()


class _Files:
    """One file per key; files that cannot be written are skipped."""

    def __init__(self, folder: Path, name: str) -> None:
        self._folder = folder
        self._name = name

    def load(self, key: object) -> object | None:
        """Return the data saved for ``key``; None if there is none or it is damaged."""
        try:
            raw = self._path(key).read_bytes()
        except OSError:
            return None
        if hashlib.sha256(raw[_SUM:]).digest() != raw[:_SUM]:
            return None
        version, kept, data = pickle.loads(raw[_SUM:])  # noqa: S301 - from the user's own folder
        return data if (version, kept) == (numba.__version__, key) else None

    def save(self, key: object, data: object) -> None:
        """Write a file atomically; do nothing if the disk refuses."""
        content = dumps((numba.__version__, key, data))
        path = self._path(key)
        with suppress(OSError):
            if not self._folder.is_dir():
                self._folder.unlink(missing_ok=True)
                self._folder.mkdir(parents=True, exist_ok=True)
            handle, temporary = tempfile.mkstemp(prefix=_TEMPORARY, dir=self._folder)
            try:
                with os.fdopen(handle, "wb") as file:
                    file.write(hashlib.sha256(content).digest() + content)
                if path.is_dir():
                    shutil.rmtree(path)
                Path(temporary).replace(path)
            finally:
                Path(temporary).unlink(missing_ok=True)

    def flush(self) -> None:
        """Delete every signature."""
        for path in self._folder.glob(f"{self._name}-*{SUFFIX}"):
            path.unlink(missing_ok=True)

    def _path(self, key: object) -> Path:
        digest = hashlib.sha256(repr(key).encode()).hexdigest()[:16]
        return self._folder / f"{self._name}-{digest}{SUFFIX}"


def drop_unfinished(folder: Path) -> None:
    """Remove the unfinished files of killed processes."""
    for path in folder.glob(f"{_TEMPORARY}*"):
        with suppress(OSError):
            if time.time() - path.stat().st_mtime > _STALE:
                path.unlink()
