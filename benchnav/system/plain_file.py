"""Open files that a user named, and only regular files: a pipe or device could block for ever."""

import errno
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from io import BufferedReader
from pathlib import Path

from benchnav.errors import StoreError

_KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}
_OPEN_FLAGS = (
    getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
)


def open_file(path: Path) -> BufferedReader:
    """Open ``path`` for reading. Raises OSError if it is missing or not a regular file."""
    _refuse_other(path, path.stat().st_mode)  # before opening: to open a device can have effects
    file = os.fdopen(os.open(path, os.O_RDONLY | _OPEN_FLAGS), "rb")
    try:
        _refuse_other(path, os.fstat(file.fileno()).st_mode)
    except OSError:
        file.close()
        raise
    return file


def read_file(path: Path, most: int) -> bytes:
    """Return the content of ``path``, of a larger file only the first ``most`` + 1 bytes.

    Raises OSError if it is missing, unreadable, or not a regular file.
    """
    with open_file(path) as file:
        return file.read(most + 1)


def require_writable(path: Path) -> None:
    """Raise OSError if ``path`` exists and is not a regular file."""
    if path.exists():
        _refuse_other(path, path.stat().st_mode)


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Create the folder of the file to write, and translate an OSError into a StoreError."""
    try:
        require_writable(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        yield
    except OSError as error:
        reason = error.strerror or error
        raise StoreError(f"{path} must be writable. The system says: {reason}.") from error


def _refuse_other(path: Path, mode: int) -> None:
    if not stat.S_ISREG(mode):
        kind = _KINDS.get(stat.S_IFMT(mode), "something else")
        raise OSError(errno.EINVAL, f"it must be a file, and is {kind}", str(path))
