"""A pool of processes that end with the caller, also after an error or Ctrl-C."""

import os
import signal
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import active_children, get_context
from typing import TypeVar

from benchnav.errors import BenchnavError
from benchnav.processes.main_module import without_main
from benchnav.processes.process_tree import end_with_parent

Task = TypeVar("Task")
Result = TypeVar("Result")


@contextmanager
def worker_pool(workers: int, cure: str) -> Iterator[Executor]:
    """Yield a pool of ``workers`` processes with one core each.

    Raises BenchnavError, which ends with ``cure``, if one of them is killed.
    """
    with ProcessPoolExecutor(workers, get_context("spawn"), _begin) as pool:
        try:
            yield pool
        except BaseException as error:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in active_children():
                process.kill()
            if not isinstance(error, BrokenProcessPool):
                raise
            raise BenchnavError(
                "Worker processes must stay alive; one was killed (see stderr for the cause;"
                f" memory may be short). {cure}"
            ) from error


def submitted(
    pool: Executor, function: Callable[[Task], Result], tasks: Iterable[Task]
) -> list[Future[Result]]:
    """Give all tasks to the pool; its processes do not import the script of the caller."""
    with without_main():
        return [pool.submit(function, task) for task in tasks]


def _begin() -> None:
    """Prepare a worker: one core, Ctrl-C handled by the parent, end with it, output to stderr."""
    end_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.environ["BENCHNAV_THREADS"] = "1"
    os.dup2(2, 1)
