"""One core of a run: a worker that plays, a measurer that measures, and the task of both."""

import pickle
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

from pydantic import TypeAdapter, ValidationError

from benchnav.errors import BenchnavError, named
from benchnav.metrics.measure import is_own
from benchnav.navigation.command_check import short
from benchnav.plugins import METRICS, Registration
from benchnav.processes.channel import ChannelError
from benchnav.processes.fork_server import Child, exit_text, start_process
from benchnav.processes.main_module import main_module
from benchnav.processes.process_tree import resident, tree
from benchnav.runner.execute.call_timer import Watch
from benchnav.runner.plan.limits import Limits
from benchnav.runner.plan.task import CHUNK, Measuring, Outcome, Played, Task

SLACK = 5.0  # [s] beyond a call's limit that nothing may happen between two calls
PATIENCE = 300.0  # [s] in which an episode must be measured
_PLAYED, _OUTCOME = TypeAdapter(Played), TypeAdapter(Outcome)
_SUDDEN = (-9, -15, -2, -1, -19)  # killed from outside: by anybody


@dataclass(frozen=True)
class Fault:
    """Why a task failed."""

    cause: str  # ends "the navigator's process …"
    fresh: bool  # whether nothing else had run in its process
    own: bool = False  # whether no code of a navigator had run in it
    sudden: bool = False  # whether another process may have killed it
    name: str = ""  # of the BenchnavError that it raised
    text: str = ""  # of that

    def error(self) -> Exception:
        """What is raised where it is nobody's but ours, or the machine's."""
        if self.name:
            return named(self.name, self.text)
        if self.text:
            return RuntimeError(f"A worker crashed:\n{self.text}")
        return BenchnavError(
            f"Worker processes must be able to work. One {self.cause} (stderr says why)."
            " A script must call this under `if __name__ == '__main__':`; 0 workers need none."
        )


class Desk:
    """At most one task at a time, which is played, then measured."""

    def __init__(self, limits: Limits, known: tuple[Registration, ...]) -> None:
        self._limits, self._known = limits, known
        self._plugins = tuple(name for name in METRICS.names() if not is_own(name))
        self._worker: Child | None = None
        self._measurer: Child | None = None
        self._watch = Watch([0.0] * 4)
        self._state: Literal["idle", "playing", "measuring"] = "idle"
        self._tasks = 0  # that the worker was given
        self._began = 0.0  # what its worker's notes counted when the task began
        self._most = 0.0  # that they may count more until it ends
        self._unmeasured = 0.0  # [s] since an episode was measured
        self.company = ""  # whom its worker serves
        self.task: Task | None = None
        self.counted = 0  # episodes of its task that were told

    def play(self, task: Task) -> None:
        """Begin a task; in a process of its own where it asks for one, or is another entry's."""
        self.task, self.counted, self._state = task, 0, "playing"
        if task.fresh or task.charge or self.company != task.company:
            self._end_worker()
        if self._worker is None:
            self._hire(task.company)
        self._tasks += 1
        self._began, self._most = self._watch.notes[0], 2.0 * task.most_calls
        self._send(self._worker, task)

    def files(self) -> list[int]:
        """For `select`: what its processes write to."""
        return [one.channel.fileno() for one in (self._worker, self._measurer) if one]

    def hear(self) -> Iterator[Fault | int | Outcome]:
        """What there is to say: episodes that were measured, a fault, or the outcome."""
        for child in (self._worker, self._measurer):
            try:
                for message in child.channel.arrived() if child else ():
                    yield from self._understood(child, message)
            except (EOFError, ChannelError) as error:
                ended = child is not None and child.join(1.0)
                how = exit_text(child.exitcode) if child is not None and ended else str(error)
                yield from self._gone(child, how or "closed what it speaks through")

    def look(self, elapsed: float) -> Fault | None:
        """What is beyond a limit, ``elapsed`` [s] after the last look."""
        if self._state == "measuring" and self._measurer is not None:
            return self._look_at_measurer(self._measurer, elapsed)
        watch, limits, worker = self._watch, self._limits, self._worker
        watch.look(elapsed)
        if self._state == "idle" or worker is None:
            watch.rest()
            return None
        if worker.exitcode is not None:
            return self._fault(exit_text(worker.exitcode), worker.exitcode)
        if watch.twice:
            return self._fault("forked, and a call returned in both processes")
        if not self._began <= watch.notes[0] <= self._began + self._most:
            return self._fault(f"went on after {watch.call()}, beyond the end of its episodes")
        if watch.lasted > limits.timeout:
            return self._fault(f"did not return from {watch.call()} within {limits.timeout:g} s")
        if watch.idle > limits.timeout + SLACK:
            return self._fault(f"did nothing for {limits.timeout + SLACK:g} s after {watch.call()}")
        if resident(worker.pid) > limits.memory * 1e9:
            return self._fault(f"held more than {limits.memory:g} GB of memory")
        return None

    def done(self) -> Task:
        """The task, which is stored."""
        return self._leave()

    def drop(self) -> Task:
        """The task, which failed; who worked at it is gone."""
        self._end_worker()
        if self._state == "measuring" and self._measurer is not None:
            self._measurer.close()
            self._measurer = None
        return self._leave()

    def processes(self) -> list[int]:
        """Its processes, and all that they started."""
        return [pid for one in (self._worker, self._measurer) if one for pid in tree(one.pid)]

    def close(self) -> None:
        """End its processes."""
        self._end_worker()
        if self._measurer is not None:
            self._measurer.close()
            self._measurer = None

    def _leave(self) -> Task:
        task, self.task, self._state = self.task, None, "idle"
        if task is None:
            raise RuntimeError("no task is at this desk")
        return task

    def _hire(self, company: str) -> None:
        self._worker = start_process("benchnav.runner.execute.worker:serve")
        self._watch, self._tasks, self.company = Watch(self._worker.notes), 0, company
        self._send(self._worker, self._known)

    def _end_worker(self) -> None:
        if self._worker is not None:
            self._worker.close()
        self._worker, self.company = None, ""

    def _send(self, child: Child | None, content: Any) -> None:
        if child is not None:
            try:
                child.channel.send_bytes(pickle.dumps(content))
            except ChannelError:
                child.kill()  # its end is heard of next

    def _measure(self, played: Played) -> None:
        self._state, self._unmeasured = "measuring", 0.0
        if self._measurer is None:
            self._measurer = start_process("benchnav.runner.execute.measurer:serve", main=False)
            measuring = Measuring(self._plugins, self._known, main_module(), self._limits.timeout)
            self._send(self._measurer, measuring)
        self._send(self._measurer, (self.task, played))

    def _understood(self, child: Child | None, message: Any) -> Iterator[Fault | int | Outcome]:
        """Nothing is believed that a worker says: it may be anything, at any time."""
        measuring = child is self._measurer
        if not (measuring or child is self._worker) or self._state != (
            "measuring" if measuring else "playing"
        ):
            return  # of another time, or a process that a worker forked
        kind = message.get("kind") if isinstance(message, dict) else None
        said = {key: value for key, value in message.items() if key != "kind"} if kind else {}
        try:
            if measuring and kind == "episodes":
                self._unmeasured, self.counted = 0.0, self.counted + 1
                yield 1
            elif measuring and kind == "done":
                yield _OUTCOME.validate_python(said)
            elif measuring and kind == "strange":
                yield self._fault(f"left what cannot be measured: {said['text']}")
            elif not measuring and kind == "played" and not self._watch.twice:
                played = _PLAYED.validate_python(said)
                if played.lacks:
                    yield Outcome(0, 0, lacks=played.lacks)
                else:
                    self._measure(played)
            elif kind in ("refused", "crashed"):
                yield self._raised(
                    kind, str(said.get("name", "")), str(said.get("text", "")), measuring
                )
            elif not self._watch.twice:
                yield self._fault("sent what is no message")
        except (ValidationError, KeyError):
            yield self._fault("sent what is no message")

    def _raised(self, kind: str, name: str, text: str, measuring: bool) -> Fault:
        last = short(text.strip().splitlines()[-1] if text.strip() else name)
        cause = f"broke: {last}"
        own = kind == "refused" if measuring else not self._watch.called
        raised = name if kind == "refused" else ""
        return Fault(cause, self._tasks == 1, own=own, name=raised, text=text or last)

    def _gone(self, child: Child | None, how: str) -> Iterator[Fault]:
        """A process ended."""
        if child not in (self._worker, self._measurer):
            return
        measuring = child is self._measurer
        if measuring and self._state != "measuring":
            self._measurer = None
        elif not measuring and self._state != "playing":
            self._end_worker()
        else:
            code = child.exitcode if child is not None else None
            yield self._fault(how, code)

    def _fault(self, cause: str, code: int | None = None) -> Fault:
        sudden = code in _SUDDEN
        own = self._state == "playing" and code is not None and not self._watch.called
        return Fault(cause, self._tasks == 1, own=own and not sudden, sudden=sudden)

    def _look_at_measurer(self, measurer: Child, elapsed: float) -> Fault | None:
        self._unmeasured += min(elapsed, 1.0)
        if measurer.exitcode is not None:
            return self._fault(exit_text(measurer.exitcode), measurer.exitcode)
        room = PATIENCE + CHUNK * len(self._plugins) * self._limits.timeout
        if self._unmeasured > room:
            return self._fault(f"left an episode that cannot be measured within {room:g} s")
        if resident(measurer.pid) > self._limits.memory * 1e9:
            return self._fault(f"left what needs more than {self._limits.memory:g} GB to measure")
        return None
