"""The fork server itself. No code of a plugin runs in it, and it has one thread."""

import ctypes
import importlib
import json
import os
import signal
import socket
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from mmap import mmap
from pathlib import Path
from select import select
from typing import Any, NoReturn

from benchnav.errors import BenchnavError
from benchnav.processes.channel import Channel, ChannelError
from benchnav.processes.process_tree import kill

LIGHT = "benchnav.navigation.plugin.capabilities"  # what plugins are made of; imported at once
WARM = "benchnav.runner.execute.preload:warm"  # what runs them: imports, and compiles where it must
PREPARE, START = b"\1", b"\0"  # what a message on the socket asks for
_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER = 1, 36


def main(file: int) -> None:
    """Serve the socket ``file`` until the other side closes it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for who asked for the processes
    _prctl(_PR_SET_CHILD_SUBREAPER, 1)  # who loses its parent becomes a child of this process
    woken, wakes = os.pipe()
    for end in (woken, wakes):
        os.set_blocking(end, False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    signal.set_wakeup_fd(wakes, warn_on_full_buffer=False)
    importlib.import_module(LIGHT)
    server = _Server(socket.socket(fileno=file), woken, wakes)
    with suppress(EOFError, ChannelError, ConnectionError):
        server.serve()
    server.end()


def load(target: str) -> Callable[..., Any]:
    """The function that "module:function" names."""
    module, _, name = target.partition(":")
    function: Callable[..., Any] = getattr(importlib.import_module(module), name)
    return function


@dataclass
class _Server:
    asked: socket.socket
    woken: int
    wakes: int
    children: set[int] = field(default_factory=set)
    is_warm: bool = False

    def __post_init__(self) -> None:
        self.channel = Channel(self.asked)

    def serve(self) -> None:
        while True:
            ready, _, _ = select([self.asked.fileno(), self.woken], [], [])
            if self.woken in ready:
                with suppress(BlockingIOError):
                    os.read(self.woken, 1 << 12)
                self._reap()
            if self.asked.fileno() in ready:
                self._start()

    def end(self) -> None:
        """Kill all that there is."""
        signal.set_wakeup_fd(-1)
        while found := _children():
            for pid in {*found, *self.children}:
                kill(pid)
            with suppress(ChildProcessError):
                os.waitpid(-1, 0)

    def _start(self) -> None:
        mark, files, _, _ = socket.recv_fds(self.asked, 1, 2)
        if not mark:
            raise EOFError
        if mark == PREPARE:
            self._warm()
            return
        said = json.loads(self.channel.receive_bytes())
        if said["warm"]:
            self._warm()
        pid = os.fork()
        if not pid:
            self._become(said, *files)
        for file in files:
            os.close(file)
        self.children.add(pid)
        self.channel.send({"started": pid})

    def _warm(self) -> None:
        """Load what a run needs, once."""
        if not self.is_warm:
            with suppress(BenchnavError):  # what cannot be used, a worker names
                load(WARM)()
            self.is_warm = True

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
                kill(pid)  # of a process that ended, or that left it on purpose

    def _become(self, said: dict[str, Any], end: int, notes: int) -> NoReturn:
        """Be the process that was asked for."""
        code = 1
        try:
            parent = os.getppid()
            signal.set_wakeup_fd(-1)
            signal.signal(signal.SIGCHLD, signal.SIG_DFL)
            for file in (self.woken, self.wakes):
                os.close(file)
            self.asked.close()
            os.setsid()
            _prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
            if os.getppid() != parent:
                raise SystemExit(1)
            with mmap(notes, 0) as shared:
                os.close(notes)
                _run(said, Channel(socket.socket(fileno=end)), shared)
            code = 0
        except SystemExit as error:
            code = error.code if isinstance(error.code, int) else 1
        except BaseException:
            traceback.print_exc()
        finally:
            with suppress(Exception):
                sys.stdout.flush()
                sys.stderr.flush()
            os._exit(code)


def _run(said: dict[str, Any], channel: Channel, shared: mmap) -> None:
    os.environ.clear()
    os.environ.update(said["environment"])
    sys.path[:] = said["path"]
    with suppress(OSError):
        os.chdir(said["folder"])
    from numpy import random

    from benchnav.processes.main_module import import_main

    random.seed()  # noqa: NPY002 - who forgets to seed draws other numbers in each process
    if said["main"]:
        import_main(said["main"])
    with memoryview(shared).cast("d") as notes:
        load(said["target"])(channel, notes)


def _children() -> list[int]:
    """The direct children of this process."""
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
