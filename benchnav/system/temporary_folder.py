"""Temporary folders that are removed with their process, however it ends.

Each folder is locked while it is used. A killed process leaves its folder unlocked, and the next
process that creates a temporary folder removes it.
"""

import os
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Self

try:
    import fcntl
except ImportError:  # Windows: folders of killed processes are not removed
    fcntl = None  # type: ignore[assignment]

_PREFIX = "benchnav-temporary-"


class TemporaryFolder:
    """A new temporary folder of this process; ``kind`` becomes part of its name.

    Raises OSError if no temporary folder can be written.
    """

    def __init__(self, kind: str) -> None:
        _drop_once()
        self.path, self._handle = _locked_folder(Path(tempfile.gettempdir()), kind)

    def remove(self) -> None:
        """Remove the folder and its content; a second call does nothing."""
        shutil.rmtree(self.path, ignore_errors=True)
        if self._handle >= 0:
            os.close(self._handle)
            self._handle = -1

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.remove()


@cache
def _drop_once() -> None:
    drop_abandoned()


def drop_abandoned() -> None:
    """Remove the folders of processes that have ended."""
    if fcntl is None:
        return
    for path in Path(tempfile.gettempdir()).glob(f"{_PREFIX}*"):
        with suppress(OSError), _opened(path) as handle:  # OSError: another process has the lock
            if os.fstat(handle).st_uid == os.geteuid():
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                shutil.rmtree(path, ignore_errors=True)


def _locked_folder(root: Path, kind: str) -> tuple[Path, int]:
    """Return the folder and the handle that locks it; -1 if the system has no locks."""
    while True:
        path = Path(tempfile.mkdtemp(prefix=f"{_PREFIX}{kind}-", dir=root))
        if fcntl is None:
            return path, -1
        handle = -1
        try:
            handle = os.open(path, os.O_RDONLY)
            with suppress(PermissionError):  # a file system without locks: nothing is removed there
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if os.path.samestat(os.fstat(handle), path.stat()):
                return path, handle
        except (BlockingIOError, FileNotFoundError):
            pass  # another process removed it before it was locked
        except BaseException:
            shutil.rmtree(path, ignore_errors=True)
            raise
        if handle >= 0:
            os.close(handle)


@contextmanager
def _opened(path: Path) -> Iterator[int]:
    """Open a folder. Raises OSError for anything else."""
    if not stat.S_ISDIR(path.lstat().st_mode):
        raise NotADirectoryError(path)
    handle = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        yield handle
    finally:
        os.close(handle)
