"""Start processes from a server in which no plugin code ever runs.

The server imports benchnav and its kernels once. Each process that it forks begins in that state
within milliseconds, whatever other processes did to theirs. A process's descendants end with it,
and all end with the process that requested them.
"""

import atexit
import json
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from mmap import mmap
from tempfile import TemporaryFile
from typing import Any

from benchnav.errors import BenchnavError
from benchnav.named_module import current_folder
from benchnav.processes.channel import Channel, ChannelError
from benchnav.processes.main_module import main_module, stop_import_of_main
from benchnav.processes.process_tree import kill
from benchnav.processes.server import PREPARE, START

ONE_THREAD = {  # a process uses one core: more threads would compete with other processes
    "BENCHNAV_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
}
_NO_THREAD = {"JE_ARROW_MALLOC_CONF": "background_thread:false"}  # fork copies one thread only
_CALL_INTERVAL = 0.2  # [s] between two calls of a function while a process starts
NOTES = 4096  # bytes of memory shared between a process and its parent
_START = (
    "import sys, json; sys.path[:] = json.loads(sys.argv[2]);"
    " from benchnav.processes.server import main; main(int(sys.argv[1]))"
)


class Child:
    """A process that the server forked: its channel, its shared notes, and its exit status."""

    def __init__(self, server: "ForkServer", channel: Channel, notes: mmap) -> None:
        self._server = server
        self.channel = channel
        self.notes: Any = memoryview(notes).cast("d")  # the process may write it at any time
        self.pid = 0
        self.exitcode: int | None = None  # negative: the signal that killed it; None: it runs

    def kill(self) -> None:
        """Kill the process and its descendants."""
        if self.exitcode is None and self.pid:
            kill(self.pid)

    def join(self, patience: float) -> bool:
        """Wait up to ``patience`` [s] for its end; return whether it ended."""
        return self._server.wait(self, patience)

    def close(self) -> None:
        """Kill the process, and remove it from the server's records."""
        self.kill()
        self.channel.close()
        self._server.forget(self)


class ForkServer:
    """The client side of the server. Raises BenchnavError if the server cannot be reached."""

    def __init__(self) -> None:
        if not hasattr(os, "fork"):
            raise BenchnavError(
                f"This system ({sys.platform}) cannot start processes by os.fork, which benchnav"
                " needs for every plugin. On Windows, use benchnav in WSL 2."
            )
        ours, theirs = socket.socketpair()
        path = json.dumps([entry or os.getcwd() for entry in sys.path])  # noqa: PTH109
        self._process = subprocess.Popen(  # noqa: S603 - this Python
            [sys.executable, "-c", _START, str(theirs.fileno()), path],
            pass_fds=[theirs.fileno()], stdin=subprocess.DEVNULL, stdout=2,
            env={**os.environ, **ONE_THREAD, **_NO_THREAD}, start_new_session=True,
        )  # fmt: skip
        theirs.close()
        self._socket, self._channel = ours, Channel(ours)
        self._children: dict[int, Child] = {}
        self._starting: list[Child] = []
        self._is_used = False
        self.owner = os.getpid()

    def fileno(self) -> int:
        """Return the descriptor for `select`: readable when `look` has news."""
        return self._channel.fileno()

    @property
    def alive(self) -> bool:
        """Whether the server still runs."""
        return self._process.poll() is None

    def prepare(self) -> None:
        """Load what a run needs in the background."""
        with suppress(OSError):  # `start` reports the cause
            self._socket.sendall(PREPARE)

    def start(
        self,
        target: str,
        main: bool = True,
        warm: bool = True,
        waiting: Callable[[], None] = lambda: None,
    ) -> Child:
        """Start ``target``, "module:function", with (channel, notes) in a new process.

        The process gets the current environment, folder and module path of this process, and with
        ``main`` also its ``__main__``. With ``warm`` it begins with the modules and kernels of a
        run, otherwise only with the modules that plugins build on.
        While the server loads or compiles these, ``waiting`` is called several times a second.
        """
        ours, theirs = socket.socketpair()
        with TemporaryFile() as file:
            file.truncate(NOTES)
            child = Child(self, Channel(ours), mmap(file.fileno(), NOTES))
            request = {
                "target": target,
                "environment": {**os.environ, **ONE_THREAD},
                "path": sys.path,
                "folder": str(current_folder()),
                "main": main_module() if main else {},
                "warm": warm,
            }
            try:
                socket.send_fds(self._socket, [START], [theirs.fileno(), file.fileno()])
                self._channel.send(request)
                self._starting.append(child)
                self._is_used = True
                while not child.pid:
                    with suppress(TimeoutError):
                        self._read_message(_CALL_INTERVAL)
                    waiting()
            except (OSError, ChannelError, BenchnavError) as error:
                child.channel.close()
                raise self._lost() from error
            finally:
                theirs.close()
        return child

    def look(self) -> None:
        """Record the processes that ended, without waiting."""
        with suppress(TimeoutError, BenchnavError):
            while True:
                self._read_message(0.0)

    def wait(self, child: Child, patience: float) -> bool:
        """Whether ``child`` ends within ``patience`` [s]."""
        if not self.alive:
            self._lost()
        with suppress(TimeoutError, BenchnavError):
            while child.exitcode is None:
                self._read_message(patience)
        return child.exitcode is not None

    def forget(self, child: Child) -> None:
        """Drop the records of a child that ended."""
        if child.exitcode is not None:
            self._children.pop(child.pid, None)

    def close(self) -> None:
        """End the server and all its processes."""
        self._channel.close()
        if self._is_used:  # else there are no processes to end
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(5.0)
        self._lost()

    def _read_message(self, patience: float | None) -> None:
        try:
            message = self._channel.receive(patience)
        except TimeoutError:  # a subclass of OSError; the server is not lost
            raise
        except (EOFError, OSError, ChannelError) as error:
            raise self._lost() from error
        if "started" in message:
            child = self._starting.pop(0)
            child.pid = message["started"]
            self._children[child.pid] = child
        elif message["ended"] in self._children:
            self._children.pop(message["ended"]).exitcode = message["status"]

    def _lost(self) -> BenchnavError:
        self._process.kill()
        self._process.wait()
        for child in self._children.values():
            child.exitcode = -9
        self._children.clear()
        return BenchnavError(
            "The process that starts workers must live as long as the run. It ended"
            f" (exit status {self._process.poll()}; see stderr for the cause)."
        )


_servers: list[ForkServer] = []


def fork_server() -> ForkServer:
    """The server of this process, which lives as long as it; a new one where there is none."""
    stop_import_of_main()
    if _servers and _servers[0].owner != os.getpid():
        _servers.clear()  # they belong to the process that this one was forked from
    if _servers and not _servers[0].alive:
        _servers.pop().close()
    if not _servers:
        _servers.append(ForkServer())
        atexit.register(_servers[0].close)
    return _servers[0]


def start_process(
    target: str, *, main: bool = True, waiting: Callable[[], None] = lambda: None
) -> Child:
    """Start ``target`` like `ForkServer.start`; retry once if a plugin killed the server."""
    try:
        return fork_server().start(target, main, waiting=waiting)
    except BenchnavError:
        return fork_server().start(target, main, waiting=waiting)


def exit_text(exitcode: int | None) -> str:
    """Return how a process ended, as text."""
    if exitcode is not None and exitcode < 0:
        known = {int(s): s.name for s in signal.Signals}
        return f"was killed by {known.get(-exitcode, f'signal {-exitcode}')}"
    return f"ended with exit status {exitcode}"
