"""A navigator's process: start it in the sandbox, exchange frames with it, and end it."""

import contextlib
import math
import os
import select
import signal
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from time import monotonic
from typing import Any, NoReturn
from weakref import finalize

from benchnav.errors import NavigatorError
from benchnav.isolation import sandbox
from benchnav.isolation.frame import (
    HEAD,
    Fields,
    decode,
    encode,
    encode_head,
    encode_parts,
    head,
    write_parts,
)
from benchnav.isolation.shared_memory import SharedMemory
from benchnav.system.temporary_folder import TemporaryFolder

_PIPE_SIZE = 1 << 20  # bytes, where the system grants them
_CHUNK = 1 << 16  # bytes of one read
_MAX_WAIT = 1 << 30  # [ms] of one call of poll
_TAIL = 2000  # bytes of its standard error that are kept
_F_SETPIPE_SZ = 1031  # Linux


class Process:
    """One process that answers frames on its standard input and output, one at a time.

    Its standard error is passed on to this process's. After a failure it is killed.
    """

    def __init__(self, command: Sequence[str]) -> None:
        folder = TemporaryFolder("navigator")
        self._memory = SharedMemory.create()
        shared = () if self._memory is None else (self._memory.descriptor,)
        try:
            self._popen = subprocess.Popen(  # noqa: S603 - the command is the user's
                [*sandbox.prefix(), *command],
                bufsize=0, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                cwd=folder.path, env=sandbox.environment(folder.path), start_new_session=True,
                pass_fds=shared,
            )  # fmt: skip
        except BaseException:
            folder.remove()
            raise
        finally:
            if self._memory is not None:
                self._memory.close_descriptor()
        self._shares = False  # whether the program takes fields from the memory
        self._pipes = [self._popen.stdin, self._popen.stdout, self._popen.stderr]
        self._in, self._out, self._err = (pipe.fileno() for pipe in self._pipes if pipe)
        self._poll = select.poll()
        for pipe in (self._in, self._out, self._err):
            os.set_blocking(pipe, False)
            _widen(pipe)
        self._poll.register(self._out, select.POLLIN)
        self._poll.register(self._err, select.POLLIN)
        self._stderr_tail = b""
        self.stop = finalize(self, _stop, self._popen, folder)

    @property
    def alive(self) -> bool:
        """Whether the process still runs."""
        return bool(self.stop.alive) and self._popen.poll() is None

    def request(self, kind: str, fields: Fields, patience: float) -> tuple[str, dict[str, Any]]:
        """Send a frame, and return (kind, fields) of the answer.

        Args:
            kind: kind of the frame sent.
            fields: fields of the frame sent.
            patience: time limit for the answer [s].

        Raises NavigatorError if the process ends, answers no frame, or takes too long.
        """
        if not self.alive:
            raise NavigatorError(self._ended())
        if (self._out, select.POLLIN) in self._poll.poll(0):
            self._fail("sent more bytes than its last answer announces")
        deadline = monotonic() + patience
        unsent, received = self._send(memoryview(self._encode(kind, fields))), bytearray()
        size = None
        if unsent:
            self._poll.register(self._in, select.POLLOUT)
        while size is None or len(received) < size:
            for pipe, _ in self._ready(deadline, patience):
                if pipe == self._in:
                    unsent = self._send(unsent)
                    if not unsent:
                        self._poll.unregister(self._in)
                elif pipe == self._err:
                    self._pass_on_stderr()
                else:
                    self._receive(received)
            if size is None and len(received) >= HEAD.size:
                size = HEAD.size + self._size(received)
        if unsent:
            self._fail("answered before it had read the whole request")
        answer = self._decode(received)
        if kind == "hello":
            self._shares = self._memory is not None and answer[1].get("memory") is True
        return answer

    def _encode(self, kind: str, fields: Fields) -> bytes | bytearray:
        """Return what the pipe must carry of a frame; the rest is in the memory."""
        if self._memory is None:
            return encode(kind, fields)
        if kind == "hello":
            self._shares = False
            return encode(kind, {**fields, "memory": self._memory.offer})
        if not self._shares:
            return encode(kind, fields)
        parts, size = encode_parts(fields)
        if size > len(self._memory.memory):
            return encode(kind, fields)
        write_parts(parts, self._memory.memory, 0)
        return encode_head(kind, len(fields), size)

    def _ready(self, deadline: float, patience: float) -> list[tuple[int, int]]:
        """Return the pipes that can be read or written. Raises NavigatorError at the deadline."""
        while True:
            left = min(max(deadline - monotonic(), 0.0) * 1e3, _MAX_WAIT)
            ready = self._poll.poll(math.ceil(left))
            if ready:
                return ready
            if monotonic() >= deadline:
                self._fail(f"did not answer within {patience:g} s")

    def peak_memory(self) -> int:
        """Return the largest memory [bytes] it held in RAM; 0 if the system does not tell."""
        most = 0
        with contextlib.suppress(OSError, ValueError, IndexError):
            own = self._popen.pid
            children = Path(f"/proc/{own}/task/{own}/children").read_text().split()
            for pid in (own, *children):
                for line in Path(f"/proc/{pid}/status").read_text().splitlines():
                    if line.startswith("VmHWM:"):
                        most = max(most, int(line.split()[1]) * 1024)
        return most

    def _send(self, unsent: memoryview) -> memoryview:
        """Write what the pipe takes now; return the rest."""
        try:
            return unsent[os.write(self._in, unsent) :]
        except BlockingIOError:
            return unsent
        except BrokenPipeError:  # its output shows its end
            return unsent[:0]

    def _receive(self, received: bytearray) -> None:
        data = os.read(self._out, _CHUNK)
        if not data:
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._popen.wait(2.0)
            self._pass_on_stderr()
            cause = self._ended()
            self.stop()
            raise NavigatorError(cause)
        received += data

    def _pass_on_stderr(self) -> None:
        """Pass on its standard error, and keep the last bytes."""
        with contextlib.suppress(BlockingIOError):
            data = os.read(self._err, _CHUNK)
            self._stderr_tail = (self._stderr_tail + data)[-_TAIL:]
            if data:
                sys.stderr.write(data.decode("utf-8", "replace"))
            else:
                with contextlib.suppress(KeyError):
                    self._poll.unregister(self._err)

    def _size(self, received: bytearray) -> int:
        try:
            return head(received)[2]
        except ValueError as error:
            self._fail(f"answered something that is not a frame: {error}")

    def _decode(self, received: bytearray) -> tuple[str, dict[str, Any]]:
        kind, count, size = head(received)
        if len(received) > HEAD.size + size:
            self._fail(f"sent more bytes than its answer {kind!r} announces")
        try:
            return kind, decode(count, received[HEAD.size :])
        except ValueError as error:  # also invalid UTF-8 or ASCII
            self._fail(f"answered something that is not a frame: {error}")

    def _fail(self, reason: str) -> NoReturn:
        self.stop()
        raise NavigatorError(f"its process {reason}")

    def _ended(self) -> str:
        code = self._popen.poll()
        if code is None:
            how = "closed its output"
        elif code < 0:
            how = f"was killed by {signal.Signals(-code).name}"
        else:
            how = f"ended with exit status {code}"
        last = self._stderr_tail.decode("utf-8", "replace").strip().splitlines()[-1:]
        return f"its process {how}" + (f" ({last[0].strip()[:200]})" if last else "")


def _widen(pipe: int) -> None:
    try:
        import fcntl

        fcntl.fcntl(pipe, _F_SETPIPE_SZ, _PIPE_SIZE)
    except (ImportError, OSError):
        pass  # keep the default size


def _stop(popen: subprocess.Popen[bytes], folder: TemporaryFolder) -> None:
    """End the process and its descendants, and remove its folder."""
    if popen.poll() is None:
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(popen.pid, signal.SIGKILL)
        popen.kill()
    popen.wait()
    for pipe in (popen.stdin, popen.stdout, popen.stderr):
        if pipe is not None:
            pipe.close()
    folder.remove()
