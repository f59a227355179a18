"""A process and its descendants: their memory use, and how to end them.

Without /proc (macOS, Windows) a process seems to have no descendants, and memory is unknown.
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
    """Return the process and all its descendants, itself first."""
    found = [pid]
    for parent in found:  # the loop extends the list
        with suppress(OSError):
            for thread in (PROC / f"{parent}/task").iterdir():
                found += map(int, (thread / "children").read_text().split())
    return found


def resident(pid: int) -> int:
    """Return the RAM [bytes] of the process tree, shared pages counted in each; 0 if unknown."""
    pages = 0
    for each in tree(pid):
        with suppress(OSError, IndexError):
            pages += int((PROC / f"{each}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") if pages else 0


def memory_is_known() -> bool:
    """Whether this system reports how much memory a process holds."""
    return resident(os.getpid()) > 0


def end_with_parent() -> None:
    """Exit this multiprocessing child as soon as its parent process ends."""
    parent = multiprocessing.parent_process()
    if parent is None:
        return

    def wait_for_its_end() -> None:
        wait([parent.sentinel])
        os._exit(1)

    Thread(target=wait_for_its_end, daemon=True).start()


def kill(pid: int) -> None:
    """Kill the whole process tree at once."""
    for each in tree(pid):
        with suppress(OSError):
            os.kill(each, getattr(signal, "SIGKILL", signal.SIGTERM))


def wait_for_end(pids: Sequence[int], patience: float) -> None:
    """Wait until all processes have ended, at most ``patience`` [s]."""
    deadline = monotonic() + patience
    while any((PROC / f"{pid}").exists() for pid in pids) and monotonic() < deadline:
        sleep(0.005)
