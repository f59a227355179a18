"""A worker process: takes tasks from a pipe, and tells what became of them.

Messages to the parent: ("ready", None), ("episodes", n), ("done", Outcome),
("refused", (name, text)) of a BenchnavError, ("crashed", traceback).
"""

import multiprocessing
import os
import signal
import sys
import traceback
from collections.abc import Sequence
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from pathlib import Path
from threading import Thread
from typing import Any

from benchnav.errors import BenchnavError
from benchnav.plugins import Registration, adopt
from benchnav.runner.watch import Notes, write_to
from benchnav.streams import prepare_streams, talk

ONE_THREAD = {  # a worker is one core: more threads would only fight those of other workers
    "BENCHNAV_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
}


def serve(
    pipe: "Connection[Any, Any]", notes: Notes, registrations: Sequence[Registration] = ()
) -> None:
    """Work until the pipe says None or closes. Runs in a process of its own.

    ``notes`` are shared with the parent, who reads from them which call lasts;
    ``registrations`` are what it knows by name and is not installed.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to handle
    prepare_streams()
    os.dup2(2, 1)  # what a navigator prints is talk, and results are the parent's
    sys.stdout = talk(sys.stdout)
    _end_with_parent()
    _go_first()
    write_to(notes)
    from benchnav.runner.source_check import SourceCheck
    from benchnav.runner.task import work

    adopt(registrations)
    check = SourceCheck()
    pipe.send(("ready", None))
    while (task := _next(pipe)) is not None:
        try:
            check.require_same(task.cell.entry)
            outcome = work(task, lambda n: pipe.send(("episodes", n)))
        except BenchnavError as error:
            pipe.send(("refused", (type(error).__name__, str(error))))
        except Exception:
            pipe.send(("crashed", traceback.format_exc()))
        else:
            pipe.send(("done", outcome))
        sys.stdout.flush()


def _end_with_parent() -> None:
    """Who outlives a parent that was killed would write beside the run that goes on."""
    parent = multiprocessing.parent_process()
    if parent is None:
        return

    def wait_for_its_end() -> None:
        wait([parent.sentinel])
        os._exit(1)

    Thread(target=wait_for_its_end, daemon=True).start()


def _go_first() -> None:
    """Where memory ends, Linux shall end a worker and not its parent."""
    with suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text("1000")


def _next(pipe: "Connection[Any, Any]") -> Any:
    try:
        return pipe.recv()
    except EOFError:
        return None
