"""A process and what it started: the memory that they hold, and their end.

Where the system shows no /proc (macOS, Windows) a process seems to be alone and memory
is not known.
"""

import multiprocessing
import os
import signal
from collections.abc import Sequence
from contextlib import suppress
from multiprocessing.connection import wait
from pathlib import Path
from threading import Thread
from time import monotonic, sleep

PROC = Path("/proc")


def tree(pid: int) -> list[int]:
    """The process and all its descendants, itself first."""
    found = [pid]
    for parent in found:  # grows while it is read
        with suppress(OSError):
            for thread in (PROC / f"{parent}/task").iterdir():
                found += map(int, (thread / "children").read_text().split())
    return found


def resident(pid: int) -> int:
    """[bytes] that the processes of its tree hold in RAM, shared pages once in each; 0: unknown."""
    pages = 0
    for each in tree(pid):
        with suppress(OSError, IndexError):
            pages += int((PROC / f"{each}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") if pages else 0


def tells_memory() -> bool:
    """Whether this system tells how much memory a process holds."""
    return resident(os.getpid()) > 0


def end_with_parent() -> None:
    """End this process, which multiprocessing began, as soon as the one that began it is gone."""
    parent = multiprocessing.parent_process()
    if parent is None:
        return

    def wait_for_its_end() -> None:
        wait([parent.sentinel])
        os._exit(1)

    Thread(target=wait_for_its_end, daemon=True).start()


def kill(pid: int) -> None:
    """End the whole tree at once, with no chance to object."""
    for each in tree(pid):
        with suppress(OSError):
            os.kill(each, getattr(signal, "SIGKILL", signal.SIGTERM))


def wait_for_end(pids: Sequence[int], patience: float) -> None:
    """Wait until none of the processes is left, and at most ``patience`` [s]."""
    deadline = monotonic() + patience
    while any((PROC / f"{pid}").exists() for pid in pids) and monotonic() < deadline:
        sleep(0.005)
