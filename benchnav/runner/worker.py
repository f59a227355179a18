"""A worker process: takes tasks from a pipe, and tells what became of them.

Messages to the parent: ("ready", None), ("episodes", n), ("done", Outcome),
("refused", (name, text)) of a BenchnavError, ("crashed", traceback).
"""

import os
import signal
import sys
import traceback
from multiprocessing.connection import Connection
from typing import Any

from benchnav import errors
from benchnav.errors import BenchnavError

ONE_THREAD = {  # a worker is one core: more threads would only fight those of other workers
    "BENCHNAV_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
}


def serve(pipe: "Connection[Any, Any]") -> None:
    """Work until the pipe says None or closes. Runs in a process of its own."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to handle
    os.dup2(2, 1)  # what a navigator prints is talk, and results are the parent's
    from benchnav.runner.task import work

    pipe.send(("ready", None))
    while (task := _next(pipe)) is not None:
        try:
            outcome = work(task, lambda n: pipe.send(("episodes", n)))
        except BenchnavError as error:
            pipe.send(("refused", (type(error).__name__, str(error))))
        except Exception:
            pipe.send(("crashed", traceback.format_exc()))
        else:
            pipe.send(("done", outcome))
        sys.stdout.flush()


def refused(name: str, text: str) -> BenchnavError:
    """The error that a worker told about."""
    kind = getattr(errors, name, BenchnavError)
    error: BenchnavError = kind.__new__(kind)
    error.args = (text,)
    return error


def _next(pipe: "Connection[Any, Any]") -> Any:
    try:
        return pipe.recv()
    except EOFError:
        return None
