"""Run kernels over a range of rows in several threads.

A kernel is compiled once, without the interpreter lock, as ``kernel(low, high, *args)``
and writes only the rows low:high, so the result does not depend on the number of
threads. This takes half the compile time of Numba's own parallel loops, and has no
threading layer that could conflict with forked or embedded processes.

Jobs wait in one queue, and each call waits for its own replies: a thread pool with futures takes
twice as long to hand a job over.
"""

import os
from collections.abc import Callable
from functools import lru_cache
from itertools import pairwise
from queue import SimpleQueue
from threading import Thread
from typing import Any

Reply = SimpleQueue[BaseException | None]
Job = tuple[Callable[..., None], tuple[Any, ...], Reply]


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
def _queue(threads: int, _process: int) -> SimpleQueue[Job]:
    """Return the queue of the threads beside the calling one; a forked process starts its own."""
    jobs = SimpleQueue[Job]()
    for k in range(threads - 1):
        Thread(target=_work, args=(jobs,), name=f"benchnav-{k}", daemon=True).start()
    return jobs


def _work(jobs: SimpleQueue[Job]) -> None:
    while True:
        kernel, args, reply = jobs.get()
        try:
            kernel(*args)
            reply.put(None)
        except BaseException as error:  # the caller raises it
            reply.put(error)
        del kernel, args, reply  # an idle thread keeps no array alive


def run_rows(kernel: Callable[..., None], rows: int, *args: Any, least: int = 16) -> None:
    """Run ``kernel(low, high, *args)`` over range(rows), in threads of ``least`` rows or more."""
    parts = rows // least
    if parts > 1:
        parts = min(thread_count(), parts)
    if parts <= 1:
        kernel(0, rows, *args)
        return
    cuts = [rows * k // parts for k in range(parts + 1)]
    jobs, reply = _queue(thread_count(), os.getpid()), Reply()
    for low, high in pairwise(cuts[1:]):
        jobs.put((kernel, (low, high, *args), reply))
    try:
        kernel(cuts[0], cuts[1], *args)
    finally:  # no thread writes to the arrays after the call
        errors = [reply.get() for _ in cuts[2:]]
    for error in errors:
        if error is not None:
            raise error
