"""Files that a user names, opened only if they are files: nothing else may block or never end."""

import errno
import os
import stat
from io import BufferedReader
from pathlib import Path

_KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}
_AT_ONCE = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)


def open_file(path: Path) -> BufferedReader:
    """Open ``path`` for reading. Raises OSError where it is not there, or is not a plain file."""
    _refuse_other(path, path.stat().st_mode)  # before it is opened, which can do things to a device
    file = os.fdopen(os.open(path, os.O_RDONLY | _AT_ONCE), "rb")
    try:
        _refuse_other(path, os.fstat(file.fileno()).st_mode)
    except OSError:
        file.close()
        raise
    return file


def read_file(path: Path, most: int) -> bytes:
    """Return the content of ``path``: of a file that is larger, ``most`` + 1 bytes.

    Raises OSError where it is not there, cannot be read, or is not a plain file.
    """
    with open_file(path) as file:
        return file.read(most + 1)


def require_writable(path: Path) -> None:
    """Raise OSError where ``path`` is something else than a file, to which one could write."""
    if path.exists():
        _refuse_other(path, path.stat().st_mode)


def _refuse_other(path: Path, mode: int) -> None:
    if not stat.S_ISREG(mode):
        kind = _KINDS.get(stat.S_IFMT(mode), "something else")
        raise OSError(errno.EINVAL, f"it must be a file, and is {kind}", str(path))
