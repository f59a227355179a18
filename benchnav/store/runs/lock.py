"""Locks: one writer per folder."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from benchnav.errors import RunConflictError, StoreError

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

LOCK = ".lock"  # is not removed; a lock on it ends with the process that holds it
MARK = ".writer"  # for systems without locks: exists while a process writes
LOCKS = (LOCK, MARK)


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold ``folder`` as its only writer.

    Raises:
        RunConflictError: another process holds it.
        StoreError: the folder is not writable.
    """
    hold = _create_mark if fcntl is None else _lock
    with hold(folder):
        yield


@contextmanager
def claimed(path: Path) -> Iterator[None]:
    """Hold the file ``path`` as its only writer until it is renamed; otherwise remove it.

    A file left by a killed process is taken over.

    Raises:
        RunConflictError: another process writes it.
        OSError: it cannot be written.
    """
    handle = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o644)
    try:
        if not _is_ours(path, handle):
            raise RunConflictError(
                f"{path} must have one writer. Another process writes it now."
                " Wait for it, or choose another folder."
            )
        try:
            yield
        except BaseException:
            path.unlink(missing_ok=True)
            raise
        finally:
            if fcntl is not None:
                fcntl.flock(handle, fcntl.LOCK_UN)
    finally:
        os.close(handle)


def _is_ours(path: Path, handle: int) -> bool:
    """Whether this process locked the file that still has this name."""
    if fcntl is None:
        return True
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return os.path.samestat(os.fstat(handle), path.stat())
    except (BlockingIOError, FileNotFoundError):
        return False


@contextmanager
def _lock(folder: Path) -> Iterator[None]:
    try:
        handle = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT, 0o644)
    except OSError as error:
        raise _not_writable(folder, error) from error
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holder = os.pread(handle, 64, 0).decode(errors="replace").strip()
            raise _in_use(folder, holder, "Wait for it, or choose another folder.") from None
        os.truncate(handle, 0)
        os.pwrite(handle, str(os.getpid()).encode(), 0)
        yield
        fcntl.flock(handle, fcntl.LOCK_UN)  # effective even if a child process has a copy of it
    finally:
        os.close(handle)


@contextmanager
def _create_mark(folder: Path) -> Iterator[None]:
    """Lock by exclusive creation of a file; a killed writer leaves it behind."""
    mark = folder / MARK
    try:
        with mark.open("x", encoding="ascii") as file:
            file.write(str(os.getpid()))
    except FileExistsError:
        holder = mark.read_text(encoding="ascii", errors="replace")
        advice = f"Wait for it, or choose another folder; delete {mark} if that process was killed."
        raise _in_use(folder, holder, advice) from None
    except OSError as error:
        raise _not_writable(folder, error) from error
    try:
        yield
    finally:
        mark.unlink(missing_ok=True)


def _in_use(folder: Path, holder: str, advice: str) -> RunConflictError:
    return RunConflictError(
        f"{folder} must have one writer. The process {holder.strip() or 'unknown'} writes it now."
        f" {advice}"
    )


def _not_writable(folder: Path, error: OSError) -> StoreError:
    return StoreError(f"{folder} is not writable: {error.strerror}.")
