"""One core of a run: a worker that plays, a measurer that measures, and the task of both."""

import pickle
from collections.abc import Callable, Iterator
from typing import Any, Literal

from pydantic import TypeAdapter, ValidationError

from benchnav.metrics.measure import is_own
from benchnav.navigation.command_check import short
from benchnav.plugins import METRICS, Registration
from benchnav.processes.channel import ChannelError
from benchnav.processes.fork_server import Child, exit_text, start_process
from benchnav.processes.main_module import is_of_main, main_of
from benchnav.processes.process_tree import resident, tree
from benchnav.runner.execute.activity import activity
from benchnav.runner.execute.call_timer import SIZE, CallTimer
from benchnav.runner.execute.task_failure import TaskFailure
from benchnav.runner.plan.limits import Limits
from benchnav.runner.plan.task import CHUNK, LARGEST, Measuring, Outcome, Played, Task

IDLE_SLACK = 5.0  # [s] added to the time limit of a call, for the time between two calls
MEASURING_TIMEOUT = 300.0  # [s] for one episode
_PLAYED, _OUTCOME = TypeAdapter(Played), TypeAdapter(Outcome)
_KILL_SIGNALS = (-9, -15, -2, -1, -19)  # exit codes that another process may have caused


class WorkerSlot:
    """A worker and a measurer, which run and then measure one task at a time."""

    def __init__(
        self,
        limits: Limits,
        registrations: tuple[Registration, ...],
        waiting: Callable[[], None] = lambda: None,
    ) -> None:
        self._limits, self._registrations = limits, registrations
        self._waiting = waiting  # is called several times a second while a worker starts
        self._plugins = tuple(name for name in METRICS.names() if not is_own(name))
        self._worker: Child | None = None
        self._measurer: Child | None = None
        self._timer = CallTimer([0.0] * SIZE)
        self._state: Literal["idle", "playing", "measuring"] = "idle"
        self._tasks = 0  # that the worker has been given
        self._first_count = 0.0  # of the call timer, when the task began
        self._max_count = 0.0  # by which that count may rise until the task ends
        self._measuring_time = 0.0  # [s] since the last episode was measured
        self.process_key = ("", "")  # of the last task of its worker
        self.task: Task | None = None
        self.reported = 0  # episodes of its task, to the progress

    def start(self, task: Task) -> None:
        """Begin a task, in a new process if the task needs one or the worker may not run it."""
        self.task, self.reported, self._state = task, 0, "playing"
        if task.new_process or task.forced_failure or not self.may_run(task):
            self._stop_worker()
        if self._worker is None:
            self._start_worker(task)
        self.process_key = task.process_key
        self._tasks += 1
        self._first_count, self._max_count = self._timer.notes[0], 2.0 * task.max_calls
        self._send(self._worker, task)
        if self._measurer is None:
            self._start_measurer()  # now, so that it is ready when the worker is

    def may_run(self, task: Task) -> bool:
        """Whether the worker has run no code of navigators or drivers but that of the task."""
        navigator, drivers = task.process_key
        return self.process_key in ((navigator, drivers), (navigator, ""))

    def files(self) -> list[int]:
        """Return the file descriptors of its channels, for `select`."""
        return [one.channel.fileno() for one in (self._worker, self._measurer) if one]

    def messages(self) -> Iterator[TaskFailure | int | Outcome]:
        """Yield new messages: numbers of measured episodes, a failure, or the outcome."""
        for child in (self._worker, self._measurer):
            try:
                for message in child.channel.arrived() if child else ():
                    yield from self._parsed(child, message)
            except (EOFError, ChannelError) as error:
                ended = child is not None and child.join(1.0)
                how = exit_text(child.exitcode) if child is not None and ended else str(error)
                yield from self._ended(child, how or "closed its channel")

    def check_limits(self, elapsed: float) -> TaskFailure | None:
        """Return a failure if a limit is exceeded, ``elapsed`` [s] after the last check."""
        if self._state == "measuring" and self._measurer is not None:
            return self._check_measurer(self._measurer, elapsed)
        timer, limits, worker = self._timer, self._limits, self._worker
        timer.look(elapsed)
        if self._state == "idle" or worker is None:
            timer.rest()
            return None
        if worker.exitcode is not None:
            return self._failure(exit_text(worker.exitcode), worker.exitcode)
        if timer.twice:
            return self._failure("forked, and a call returned in both processes")
        if not self._first_count <= timer.notes[0] <= self._first_count + self._max_count:
            return self._failure(f"went on after {timer.call()}, beyond the end of its episodes")
        if timer.lasted > limits.timeout:
            return self._failure(f"did not return from {timer.call()} within {limits.timeout:g} s")
        if timer.idle > limits.timeout + IDLE_SLACK:
            return self._failure(
                f"did nothing for {limits.timeout + IDLE_SLACK:g} s after {timer.call()}"
            )
        if resident(worker.pid) > limits.memory * 1e9:
            return self._failure(f"held more than {limits.memory:g} GB of memory")
        return None

    def activity(self) -> str:
        """Return what it does now, as a text; "" if it has no task or starts a process."""
        if self.task is None:
            return ""
        return activity(self.task, self._timer, self._state == "measuring")

    def finish(self) -> Task:
        """Return the task, which is stored, and free the slot."""
        return self._free()

    def abort(self) -> Task:
        """Return the task, which failed; stop the processes that ran it, and free the slot."""
        self._stop_worker()
        if self._state == "measuring":
            self._stop_measurer()
        return self._free()

    def processes(self) -> list[int]:
        """Return the process numbers of its processes and of all their children."""
        return [pid for one in (self._worker, self._measurer) if one for pid in tree(one.pid)]

    def close(self) -> None:
        """End its processes."""
        self._stop_worker()
        self._stop_measurer()

    def _free(self) -> Task:
        task, self.task, self._state = self.task, None, "idle"
        if task is None:
            raise RuntimeError("this slot has no task")
        return task

    def _start_worker(self, task: Task) -> None:
        places = (*task.job.places, *(value for _, _, value in self._registrations))
        self._worker = start_process(
            "benchnav.runner.execute.worker:serve", main=is_of_main(places), waiting=self._waiting
        )
        self._timer, self._tasks = CallTimer(self._worker.notes), 0
        self._send(self._worker, self._registrations)

    def _stop_worker(self) -> None:
        if self._worker is not None:
            self._worker.close()
        self._worker, self.process_key = None, ("", "")

    def _send(self, child: Child | None, content: Any) -> None:
        if child is not None:
            try:
                child.channel.send_bytes(pickle.dumps(content))
            except ChannelError:
                child.kill()  # the next call of `messages` reports its end

    def _start_measurer(self) -> None:
        self._measurer = start_process("benchnav.runner.execute.measurer:serve", main=False)
        main = main_of(value for _, _, value in self._registrations)
        measuring = Measuring(self._plugins, self._registrations, main, self._limits.timeout)
        self._send(self._measurer, measuring)

    def _stop_measurer(self) -> None:
        if self._measurer is not None:
            self._measurer.close()
        self._measurer = None

    def _measure(self, played: Played) -> None:
        self._state, self._measuring_time = "measuring", 0.0
        if self._measurer is None:  # it ended while the worker played
            self._start_measurer()
        self._send(self._measurer, (self.task, played))

    def _parsed(self, child: Child | None, message: Any) -> Iterator[TaskFailure | int | Outcome]:
        """Validate a message: a worker may send anything at any time."""
        measuring = child is self._measurer
        if not (measuring or child is self._worker) or self._state != (
            "measuring" if measuring else "playing"
        ):
            return  # it came late, or from a process that a worker forked
        kind = message.get("kind") if isinstance(message, dict) else None
        fields = {key: value for key, value in message.items() if key != "kind"} if kind else {}
        try:
            if measuring and kind == "episodes":
                count = int(fields["count"])
                self._measuring_time, self.reported = 0.0, self.reported + count
                yield count
            elif measuring and kind == "done":
                yield _OUTCOME.validate_python(fields)
            elif measuring and kind == "strange":
                yield self._failure(f"wrote episodes that cannot be measured: {fields['text']}")
            elif not measuring and kind == "played" and not self._timer.twice:
                played = _PLAYED.validate_python(fields)
                if played.missing_extra:
                    yield Outcome(0, 0, missing_extra=played.missing_extra)
                else:
                    self._measure(played)
            elif kind in ("refused", "crashed"):
                yield self._raised(
                    kind, str(fields.get("name", "")), str(fields.get("text", "")), measuring
                )
            elif not self._timer.twice:
                yield self._failure("sent an invalid message")
        except (ValidationError, KeyError):
            yield self._failure("sent an invalid message")

    def _raised(self, kind: str, name: str, text: str, measuring: bool) -> TaskFailure:
        last = short(text.strip().splitlines()[-1] if text.strip() else name)
        cause = f"broke: {last}"
        internal = kind == "refused" if measuring else not self._timer.called
        raised = name if kind == "refused" else ""
        return TaskFailure(
            cause, self._tasks == 1, internal=internal, error_name=raised, error_text=text or last
        )

    def _ended(self, child: Child | None, how: str) -> Iterator[TaskFailure]:
        """Report the end of a process."""
        if child not in (self._worker, self._measurer):
            return
        measuring = child is self._measurer
        if measuring and self._state != "measuring":
            self._stop_measurer()
        elif not measuring and self._state != "playing":
            self._stop_worker()
        else:
            code = child.exitcode if child is not None else None
            yield self._failure(how, code)

    def _failure(self, cause: str, code: int | None = None) -> TaskFailure:
        killed_externally = code in _KILL_SIGNALS
        internal = self._state == "playing" and code is not None and not self._timer.called
        return TaskFailure(
            cause,
            self._tasks == 1,
            internal=internal and not killed_externally,
            killed_externally=killed_externally,
        )

    def _check_measurer(self, measurer: Child, elapsed: float) -> TaskFailure | None:
        self._measuring_time += min(elapsed, 1.0)
        if measurer.exitcode is not None:
            return self._failure(exit_text(measurer.exitcode), measurer.exitcode)
        room = MEASURING_TIMEOUT + LARGEST * CHUNK * len(self._plugins) * self._limits.timeout
        if self._measuring_time > room:
            return self._failure(f"wrote an episode that cannot be measured within {room:g} s")
        if resident(measurer.pid) > self._limits.memory * 1e9:
            return self._failure(
                f"wrote episodes that need more than {self._limits.memory:g} GB to measure"
            )
        return None
