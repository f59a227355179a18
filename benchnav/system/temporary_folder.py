"""Folders among the temporary files, which go with their process however it ends.

Each is locked while it is used. A process that was killed leaves its folder unlocked, and the
next one that makes a folder removes it.
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
except ImportError:  # not on Windows, where what a killed process leaves stays
    fcntl = None  # type: ignore[assignment]

_PREFIX = "benchnav-temporary-"


class TemporaryFolder:
    """A new folder of this process; ``kind`` becomes part of its name.

    Raises OSError where no folder of temporary files can be written.
    """

    def __init__(self, kind: str) -> None:
        _drop_once()
        self.path, self._handle = _locked_folder(Path(tempfile.gettempdir()), kind)

    def remove(self) -> None:
        """Remove it and everything in it; once more does nothing."""
        shutil.rmtree(self.path, ignore_errors=True)
        if self._handle >= 0:
            os.close(self._handle)
            self._handle = -1

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *raised: object) -> None:
        self.remove()


@cache
def _drop_once() -> None:
    drop_abandoned()


def drop_abandoned() -> None:
    """Remove the folders of processes that are gone."""
    if fcntl is None:
        return
    for path in Path(tempfile.gettempdir()).glob(f"{_PREFIX}*"):
        with suppress(OSError), _opened(path) as handle:  # OSError: another process holds it
            if os.fstat(handle).st_uid == os.geteuid():
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                shutil.rmtree(path, ignore_errors=True)


def _locked_folder(root: Path, kind: str) -> tuple[Path, int]:
    """Return the folder and the handle that locks it; -1 where there are no locks."""
    while True:
        path = Path(tempfile.mkdtemp(prefix=f"{_PREFIX}{kind}-", dir=root))
        if fcntl is None:
            return path, -1
        handle = -1
        try:
            handle = os.open(path, os.O_RDONLY)
            with suppress(PermissionError):  # a file system without locks: nothing is dropped there
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if os.path.samestat(os.fstat(handle), path.stat()):
                return path, handle
        except (BlockingIOError, FileNotFoundError):
            pass  # another process took it for abandoned before it was locked
        except BaseException:
            shutil.rmtree(path, ignore_errors=True)
            raise
        if handle >= 0:
            os.close(handle)


@contextmanager
def _opened(path: Path) -> Iterator[int]:
    """Raise OSError for anything but a folder."""
    if not stat.S_ISDIR(path.lstat().st_mode):
        raise NotADirectoryError(path)
    handle = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        yield handle
    finally:
        os.close(handle)
