"""Run kernels over a range of rows in several threads.

A kernel is compiled once, without the interpreter lock, as ``kernel(low, high, *args)``
and writes only the rows low:high, so the result does not depend on the number of
threads. This takes half the compile time of Numba's own parallel loops, and has no
threading layer that could conflict with forked or embedded processes.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from itertools import pairwise
from typing import Any


def core_count() -> int:
    """Return the number of cores this process may use, or of the machine if that is unknown."""
    if hasattr(os, "sched_getaffinity"):  # Linux
        return len(os.sched_getaffinity(0))
    count = getattr(os, "process_cpu_count", os.cpu_count)  # the former from Python 3.13
    return count() or 1


def thread_count() -> int:
    """Return the number of threads for kernels: BENCHNAV_THREADS, or `core_count`."""
    return int(os.environ.get("BENCHNAV_THREADS", "0")) or core_count()


@lru_cache(maxsize=1)
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads - 1, thread_name_prefix="benchnav")


def run_rows(kernel: Callable[..., None], rows: int, *args: Any, least: int = 16) -> None:
    """Run ``kernel(low, high, *args)`` over range(rows), in threads of ``least`` rows or more."""
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
