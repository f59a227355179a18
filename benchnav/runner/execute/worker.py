"""A worker process: runs tasks of one navigator, and writes episodes that are measured elsewhere.

Messages to the parent: {"kind": "played", …}, {"kind": "refused", "name", "text"} for a
BenchnavError, {"kind": "crashed", "text"} for any other exception.
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
    """Run tasks until the channel closes. The first message holds the registrations of the parent.

    ``notes`` are shared with the parent, which measures the calls of navigators with them.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent handles Ctrl-C
    prepare_streams()
    sys.stdout = message_stream(sys.stdout)  # output of a navigator goes to stderr
    _prefer_to_be_killed()
    write_to(notes, getpid())
    check = SourceCheck()
    registrations = pickle.loads(channel.receive_bytes())  # noqa: S301 - from the parent
    while True:
        try:
            task: Task = pickle.loads(channel.receive_bytes())  # noqa: S301
        except EOFError:
            return
        channel.send(_answer(task, check, registrations))
        registrations = registrations if task.forced_failure else ()
        sys.stdout.flush()


def _answer(
    task: Task, check: SourceCheck, registrations: Sequence[Registration]
) -> dict[str, Any]:
    beat()
    try:
        if not task.forced_failure:
            check.require_same(task.job.contestant)
            if registrations:
                with calling("__init__"):
                    adopt(registrations)
        return {"kind": "played", **asdict(play(task))}
    except BenchnavError as error:
        return {"kind": "refused", "name": type(error).__name__, "text": plain(error)}
    except Exception as error:
        # raised by benchnav: exceptions of a navigator are caught at its call
        text = bounded(traceback.format_exc())
        return {"kind": "crashed", "name": type(error).__name__, "text": text}


def _prefer_to_be_killed() -> None:
    """Make Linux end this worker, and not its parent, if memory runs out."""
    with suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text("1000")
