"""The fork server itself. It runs no plugin code, and has one thread."""

import ctypes
import importlib
import json
import os
import signal
import socket
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from mmap import mmap
from pathlib import Path
from select import select
from typing import Any, NoReturn

from benchnav.errors import BenchnavError
from benchnav.processes.channel import Channel, ChannelClosedError, ChannelError
from benchnav.processes.process_tree import kill

LIGHT = (
    "benchnav.navigation.plugin.capabilities"  # the modules that plugins build on; imported at once
)
WARM = "benchnav.runner.execute.preload:warm"  # loads the modules and kernels of a run in steps
PREPARE, START = b"\1", b"\0"  # the kinds of requests on the socket
_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER = 1, 36


def main(file: int) -> None:
    """Serve the socket ``file`` until the other side closes it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the requesting process handles Ctrl-C
    _prctl(_PR_SET_CHILD_SUBREAPER, 1)  # orphans become children of this process
    wake_reader, wake_writer = os.pipe()
    for end in (wake_reader, wake_writer):
        os.set_blocking(end, False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    signal.set_wakeup_fd(wake_writer, warn_on_full_buffer=False)
    importlib.import_module(LIGHT)
    server = _Server(socket.socket(fileno=file), wake_reader, wake_writer)
    with suppress(EOFError, ChannelError, ConnectionError):
        server.serve()
    server.end()
    os._exit(0)  # nothing is left to do, and Numba's objects take long to be dismantled


def load(target: str) -> Callable[..., Any]:
    """Return the function that "module:function" names."""
    module, _, name = target.partition(":")
    function: Callable[..., Any] = getattr(importlib.import_module(module), name)
    return function


def _warm_steps() -> Iterator[int | None]:
    """Load what a run needs; other requests may be served between two steps.

    Yields the numbers of processes that help, else None.
    """
    with suppress(BenchnavError):  # a worker reports what cannot be used
        yield from load(WARM)()


@dataclass
class _Server:
    requests: socket.socket
    wake_reader: int
    wake_writer: int
    children: set[int] = field(default_factory=set)
    steps: Iterator[int | None] = field(default_factory=_warm_steps)  # those that are left
    is_loading: bool = False

    def __post_init__(self) -> None:
        self.channel = Channel(self.requests)

    def serve(self) -> None:
        while True:
            patience = 0.0 if self.is_loading else None
            ready, _, _ = select([self.requests.fileno(), self.wake_reader], [], [], patience)
            if not ready:
                self._load_step()
            if self.wake_reader in ready:
                with suppress(BlockingIOError):
                    os.read(self.wake_reader, 1 << 12)
                self._reap()
            if self.requests.fileno() in ready:
                self._start()

    def end(self) -> None:
        """Kill all processes that the server started."""
        signal.set_wakeup_fd(-1)
        while found := _children():
            for pid in {*found, *self.children}:
                kill(pid)
            with suppress(ChildProcessError):
                os.waitpid(-1, 0)

    def _start(self) -> None:
        mark, files, _, _ = socket.recv_fds(self.requests, 1, 2)
        if not mark:
            raise EOFError
        if mark == PREPARE:
            self.is_loading = True
            return
        request = json.loads(self.channel.receive_bytes())
        if request["warm"]:
            while self._load_step():
                pass
        pid = os.fork()
        if not pid:
            self._become(request, *files)
        for file in files:
            os.close(file)
        self.children.add(pid)
        self.channel.send({"started": pid})

    def _load_step(self) -> bool:
        """Load a part of what a run needs; return whether one was left."""
        for helper in self.steps:
            if helper is not None:
                self.children.add(helper)
            return True
        self.is_loading = False
        return False

    def _reap(self) -> None:
        with suppress(ChildProcessError):
            while (found := os.waitpid(-1, os.WNOHANG))[0]:
                pid, status = found
                if pid in self.children:
                    self.children.discard(pid)
                    code = os.waitstatus_to_exitcode(status)
                    self.channel.send({"ended": pid, "status": code})
        for pid in _children():
            if pid not in self.children and _session(pid) not in self.children:
                kill(pid)  # an orphan: its process ended, or it left the session on purpose

    def _become(self, request: dict[str, Any], end: int, notes: int) -> NoReturn:
        """Become the requested process."""
        code = 1
        try:
            parent = os.getppid()
            signal.set_wakeup_fd(-1)
            signal.signal(signal.SIGCHLD, signal.SIG_DFL)
            for file in (self.wake_reader, self.wake_writer):
                os.close(file)
            self.requests.close()
            os.setsid()
            _prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
            if os.getppid() != parent:
                raise SystemExit(1)
            with mmap(notes, 0) as shared:
                os.close(notes)
                _run(request, Channel(socket.socket(fileno=end)), shared)
            code = 0
        except SystemExit as error:
            code = error.code if isinstance(error.code, int) else 1
        except ChannelClosedError:
            pass  # the parent was killed: no process reads a report
        except BaseException:
            traceback.print_exc()
        finally:
            with suppress(Exception):
                sys.stdout.flush()
                sys.stderr.flush()
            os._exit(code)


def _run(request: dict[str, Any], channel: Channel, shared: mmap) -> None:
    os.environ.clear()
    os.environ.update(request["environment"])
    sys.path[:] = request["path"]
    with suppress(OSError):
        os.chdir(request["folder"])
    from numpy import random

    from benchnav.processes.main_module import import_main

    random.seed()  # noqa: NPY002 - unseeded draws must differ between processes
    if request["main"]:
        import_main(request["main"])
    with memoryview(shared).cast("d") as notes:
        load(request["target"])(channel, notes)


def _children() -> list[int]:
    """Return the direct children of this process."""
    found: list[int] = []
    with suppress(OSError):
        for thread in Path("/proc/self/task").iterdir():
            found += map(int, (thread / "children").read_text().split())
    return found


def _session(pid: int) -> int:
    try:
        return os.getsid(pid)
    except OSError:
        return 0


def _prctl(option: int, value: int) -> None:
    if sys.platform.startswith("linux"):
        ctypes.CDLL(None).prctl(option, value, 0, 0, 0)
