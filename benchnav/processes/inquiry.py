"""Questions to separate processes, which may hang, die or answer nonsense.

One process answers a list of questions in order. If it fails, its current question gets a
`Fault`, and a new process continues with the next one. Several lists are answered in parallel.
"""

from collections import deque
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from select import select
from time import monotonic
from typing import Any

from benchnav.errors import BenchnavError
from benchnav.processes.channel import ChannelError
from benchnav.processes.fork_server import Child, ForkServer, exit_text, fork_server
from benchnav.processes.process_tree import resident
from benchnav.threads import core_count

_POLL = 0.1  # [s] between checks of a process's progress and memory
_END = 5.0  # [s] until a process that closed its channel must have ended


@dataclass(frozen=True)
class Inquiry:
    """Questions for one process; for ``target`` see `ForkServer.start`."""

    target: str
    questions: Sequence[Any]  # JSON values


@dataclass(frozen=True)
class Step:
    """A part of an answer; the process notes the number of the step that it begins."""

    name: str
    patience: float  # [s] time limit of the step


@dataclass(frozen=True)
class Fault:
    """The reason why there is no answer: "it did not return from __init__ within 2 s"."""

    text: str


@dataclass(frozen=True)
class Limits:
    """The limits of an answer."""

    steps: Sequence[Step]
    memory: float  # [bytes] that the process may hold in RAM


def inquire(inquiries: Sequence[Inquiry], limits: Limits) -> list[list[Any | Fault]]:
    """Return the answers to the questions of each inquiry, in order; a `Fault` for no answer.

    Raises BenchnavError if no process can be started.
    """
    answers: list[list[Any | Fault]] = [[] for _ in inquiries]
    waiting = deque(k for k, inquiry in enumerate(inquiries) if inquiry.questions)
    running: dict[int, _RunningInquiry] = {}
    most = core_count()
    try:
        while waiting or running:
            try:
                while waiting and len(running) < most:
                    running[waiting[0]] = _RunningInquiry.begin(
                        inquiries[waiting[0]], len(answers[waiting[0]])
                    )
                    waiting.popleft()
                select(
                    [active.child.channel for active in running.values()],
                    [],
                    [],
                    _POLL,
                )
                _collect(answers, waiting, running, limits, alone=most == 1)
            except _ServerLost as lost:  # one of the processes ended it: ask each again, alone
                if most == 1 and not running and lost.__cause__ is not None:
                    raise lost.__cause__ from None
                waiting.extendleft(reversed(running))
                _close(running)
                most = 1
    finally:
        _close(running)
    return answers


class _ServerLost(Exception):
    """The process that starts processes ended, and all others with it."""


def _collect(
    answers: list[list[Any | Fault]], waiting: deque[int], running: "dict[int, _RunningInquiry]",
    limits: Limits, alone: bool,
) -> None:  # fmt: skip
    """Collect the answers that arrived."""
    for k, active in list(running.items()):
        found = active.look(limits, alone)
        answers[k] += found
        failed = any(isinstance(answer, Fault) for answer in found)
        if failed or not active.left:
            running.pop(k).child.close()
            if active.left:
                waiting.append(k)


def _close(running: "dict[int, _RunningInquiry]") -> None:
    while running:
        running.popitem()[1].child.close()


@dataclass
class _RunningInquiry:
    """A process, and its current question."""

    server: ForkServer  # that started the process
    child: Child
    left: int  # questions without an answer
    since: float = field(default_factory=monotonic)  # when the current question began
    begun: float = 0.0  # when the current step began
    step: int = 0

    @classmethod
    def begin(cls, inquiry: Inquiry, answered: int) -> "_RunningInquiry":
        questions = list(inquiry.questions)[answered:]
        server = fork_server()
        try:
            child = server.start(inquiry.target, main=False, warm=False)
        except BenchnavError as error:
            raise _ServerLost from error
        with suppress(ChannelError):  # `look` notices the end of the process
            child.channel.send(questions)
        return cls(server, child, len(questions), begun=monotonic())

    def look(self, limits: Limits, alone: bool) -> list[Any | Fault]:
        """Return the answers that arrived, with a `Fault` last if the process failed.

        Raises _ServerLost if a process other than this one may have ended the server; with
        ``alone`` there is no other.
        """
        found: list[Any | Fault] = []
        try:
            if select([self.child.channel], [], [], 0.0)[0]:
                found += self.child.channel.arrived()[: self.left]
        except EOFError:
            found.append(Fault(self._end(alone) + self._during(limits)))
        except ChannelError as error:
            found.append(Fault(str(error)))
        if found:
            self.left -= len(found)
            self.since = self.begun = monotonic()
            self.step = 0
            return found
        if why := self._overdue(limits):
            self.left -= 1
            return [Fault(why)]
        return []

    def _end(self, alone: bool) -> str:
        self.child.join(_END)
        if not self.server.alive:
            if alone:
                return "it ended the process that had started it"
            raise _ServerLost
        code = self.child.exitcode
        return (
            "its process closed its channel" if code is None else f"its process {exit_text(code)}"
        )

    def _overdue(self, limits: Limits) -> str:
        """Return how the process exceeds a limit; "" if it does not."""
        now, step = monotonic(), self._noted_step(limits)
        if step > self.step:
            self.step, self.begun = step, now
        name, patience = limits.steps[self.step].name, limits.steps[self.step].patience
        if now - self.begun > patience or now - self.since > sum(s.patience for s in limits.steps):
            return f"it did not return from {name} within {patience:g} s"
        if resident(self.child.pid) > limits.memory:
            return f"it held more than {limits.memory / 1e9:g} GB of memory{self._during(limits)}"
        return ""

    def _noted_step(self, limits: Limits) -> int:
        """Return the process's current step; its notes may hold any number."""
        noted = self.child.notes[0]
        return int(noted) if 0 <= noted < len(limits.steps) else 0

    def _during(self, limits: Limits) -> str:
        return f" in {limits.steps[max(self.step, self._noted_step(limits))].name}"
