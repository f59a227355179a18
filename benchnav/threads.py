"""Kernels over a range of rows, shared between threads.

A kernel is compiled once, without the interpreter lock, as ``kernel(low, high, *args)``
and writes only the rows low:high, so the result does not depend on the number of
threads. This costs half the compile time of Numba's own parallel loops, and has no
threading layer that could disagree with forked or embedded processes.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from itertools import pairwise
from typing import Any


def core_count() -> int:
    """Cores that this process may run on, or those of the machine where no system call tells."""
    if hasattr(os, "sched_getaffinity"):  # Linux
        return len(os.sched_getaffinity(0))
    count = getattr(os, "process_cpu_count", os.cpu_count)  # the former from Python 3.13
    return count() or 1


def thread_count() -> int:
    """Threads that kernels use: BENCHNAV_THREADS, or the cores this process may run on."""
    return int(os.environ.get("BENCHNAV_THREADS", "0")) or core_count()


@lru_cache(maxsize=1)
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads - 1, thread_name_prefix="benchnav")


def run_rows(kernel: Callable[..., None], rows: int, *args: Any, least: int = 16) -> None:
    """``kernel(low, high, *args)`` over range(rows), in threads of at least ``least`` rows each."""
    parts = min(thread_count(), rows // least)
    if parts <= 1:
        kernel(0, rows, *args)
        return
    cuts = [rows * k // parts for k in range(parts + 1)]
    jobs = [
        _pool(thread_count()).submit(kernel, low, high, *args) for low, high in pairwise(cuts[1:])
    ]
    kernel(cuts[0], cuts[1], *args)
    for job in jobs:
        job.result()
