"""A worker process: plays tasks of one entry, and leaves their episodes to be measured.

Messages to the parent: {"kind": "played", …}, {"kind": "refused", "name", "text"} of a
BenchnavError, {"kind": "crashed", "text"}.
"""

import pickle
import signal
import sys
import traceback
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict
from os import getpid
from pathlib import Path
from typing import Any

from benchnav.errors import BenchnavError
from benchnav.navigation.plugin.trace import bounded, plain
from benchnav.plugins import Registration, adopt
from benchnav.processes.channel import Channel
from benchnav.runner.execute.call_timer import Notes, beat, calling, write_to
from benchnav.runner.plan.source_check import SourceCheck
from benchnav.runner.plan.task import Task, play
from benchnav.system.streams import message_stream, prepare_streams


def serve(channel: Channel, notes: Notes) -> None:
    """Work until the channel closes. The first message is what was registered elsewhere.

    ``notes`` are shared with the parent, who reads from them which call lasts.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to handle
    prepare_streams()
    sys.stdout = message_stream(sys.stdout)  # what a navigator prints goes to stderr
    _go_first()
    write_to(notes, getpid())
    check = SourceCheck()
    registrations = pickle.loads(channel.receive_bytes())  # noqa: S301 - of who started this
    while True:
        try:
            task: Task = pickle.loads(channel.receive_bytes())  # noqa: S301
        except EOFError:
            return
        channel.send(_answer(task, check, registrations))
        registrations = registrations if task.charge else ()
        sys.stdout.flush()


def _answer(
    task: Task, check: SourceCheck, registrations: Sequence[Registration]
) -> dict[str, Any]:
    beat()
    try:
        if not task.charge:
            check.require_same(task.cell.entry)
            if registrations:
                with calling("__init__"):
                    adopt(registrations)
        return {"kind": "played", **asdict(play(task))}
    except BenchnavError as error:
        return {"kind": "refused", "name": type(error).__name__, "text": plain(error)}
    except Exception as error:
        # of benchnav's own code: what a navigator raises is caught where it is called
        text = bounded(traceback.format_exc())
        return {"kind": "crashed", "name": type(error).__name__, "text": text}


def _go_first() -> None:
    """Where memory ends, Linux shall end a worker and not its parent."""
    with suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text("1000")
