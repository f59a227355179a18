"""One writer a folder."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from benchnav.errors import RunConflictError, StoreError

try:
    import fcntl
except ImportError:  # not on Windows
    fcntl = None  # type: ignore[assignment]

LOCK = ".lock"  # stays; the system forgets a lock on it with the process that held it
MARK = ".writer"  # where there are no such locks: there while somebody writes
LOCKS = (LOCK, MARK)


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold ``folder`` as its only writer.

    Raises:
        RunConflictError: another process holds it.
        StoreError: the folder is not writable.
    """
    hold = _marked if fcntl is None else _flocked
    with hold(folder):
        yield


@contextmanager
def claimed(path: Path) -> Iterator[None]:
    """Hold the file ``path`` as its only writer until it is renamed; else it is removed.

    What a process that was killed left there is taken over.

    Raises:
        RunConflictError: another process writes it.
        OSError: it cannot be written.
    """
    handle = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o644)
    try:
        if not _is_ours(path, handle):
            raise RunConflictError(
                f"{path} must have one writer. Another process writes it now."
                " Wait for it, or give another --out."
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
    """Whether this process could lock the file, and it is still the one of that name."""
    if fcntl is None:
        return True
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return os.path.samestat(os.fstat(handle), path.stat())
    except (BlockingIOError, FileNotFoundError):
        return False


@contextmanager
def _flocked(folder: Path) -> Iterator[None]:
    try:
        handle = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT, 0o644)
    except OSError as error:
        raise _refused(folder, error) from error
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holder = os.pread(handle, 64, 0).decode(errors="replace").strip()
            raise _taken(folder, holder, "Wait for it, or give another --out.") from None
        os.truncate(handle, 0)
        os.pwrite(handle, str(os.getpid()).encode(), 0)
        yield
        fcntl.flock(handle, fcntl.LOCK_UN)  # also where a child still holds a copy of it
    finally:
        os.close(handle)


@contextmanager
def _marked(folder: Path) -> Iterator[None]:
    """By exclusive creation: a writer that was killed leaves its mark behind."""
    mark = folder / MARK
    try:
        with mark.open("x", encoding="ascii") as file:
            file.write(str(os.getpid()))
    except FileExistsError:
        holder = mark.read_text(encoding="ascii", errors="replace")
        advice = f"Wait for it, or give another --out; delete {mark} where it was killed."
        raise _taken(folder, holder, advice) from None
    except OSError as error:
        raise _refused(folder, error) from error
    try:
        yield
    finally:
        mark.unlink(missing_ok=True)


def _taken(folder: Path, holder: str, advice: str) -> RunConflictError:
    return RunConflictError(
        f"{folder} must have one writer. The process {holder.strip() or 'unknown'} writes it now."
        f" {advice}"
    )


def _refused(folder: Path, error: OSError) -> StoreError:
    return StoreError(f"{folder} must be writable. The system says: {error.strerror}.")
