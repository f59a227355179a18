"""The execution of tasks in local worker processes, which may crash or hang.

A pool has one `WorkerSlot` per core: a worker, which runs the tasks of one navigator and is
replaced for the next one, and a measurer, which never runs code of a navigator. A navigator is
charged with a failure only after a task of a single seed failed in a new process.
"""

import os
from collections import deque
from collections.abc import Generator, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from select import select
from tempfile import TemporaryFile
from time import monotonic
from typing import Any

from benchnav.plugins import Registration, registrations
from benchnav.processes.fork_server import fork_server
from benchnav.processes.process_tree import wait_for_end
from benchnav.runner.execute.progress import Progress
from benchnav.runner.execute.task_failure import TaskFailure
from benchnav.runner.execute.worker_slot import WorkerSlot
from benchnav.runner.plan.limits import Limits
from benchnav.runner.plan.task import Outcome, Task, work
from benchnav.store.parts.part import Part
from benchnav.store.parts.part_writer import discard

Finished = tuple[Task, Outcome]
_MIN_FREE_BYTES = 16 << 20  # more than the episodes of most tasks
EXIT_TIMEOUT = 2.0  # [s] for killed processes to close their files
CHECK_INTERVAL = 0.1  # [s] between two checks of the workers' calls and memory


def execute(
    tasks: Sequence[Task], workers: int, progress: Progress, limits: Limits
) -> Generator[Finished, None, None]:
    """Run tasks, and yield each one after it is stored. The order is not defined.

    Args:
        tasks: in the order in which they start, except that a worker prefers tasks of the
            navigator that it already runs.
        workers: the number of processes; 0 runs the tasks in this process, without limits and
            without protection against crashes.
        progress: is updated after every finished episode.
        limits: of time and memory.

    Raises:
        BenchnavError: a task raised it. Every task that was yielded is stored.

    Close the generator to stop the workers early.
    """
    if workers == 0:
        for task in tasks:
            progress.start(0, task.load)
            outcome = work(task, progress.advance)
            progress.finish(0)
            yield task, outcome
        return
    pool = WorkerPool(min(workers, len(tasks)), progress, limits)
    try:
        yield from pool.run(tasks)
    finally:
        pool.close()


@dataclass
class WorkerPool:
    """Worker slots, which are kept between batches of tasks."""

    size: int
    progress: Progress
    limits: Limits
    registrations: Iterable[Registration] | None = None  # None: those of this process
    pending: deque[Task] = field(default_factory=deque)
    exclusive_tasks: deque[Task] = field(default_factory=deque)
    """Tasks whose process was killed from outside, and which now run while no other task does."""
    slots: list[WorkerSlot] = field(default_factory=list)
    checked_at: float = 0.0

    def run(self, tasks: Sequence[Task]) -> Iterator[Finished]:
        """Run tasks, as `execute` does."""
        self.pending.extend(tasks)
        self.checked_at = monotonic()
        known = registrations() if self.registrations is None else self.registrations
        while len(self.slots) < self.size:
            self.slots.append(WorkerSlot(self.limits, tuple(known), self._look))
        while self.pending or self.exclusive_tasks or self._busy():
            self._assign()
            files = {file: slot for slot in self.slots for file in slot.files()}
            fork_server().look()
            ready, _, _ = select([*files, fork_server().fileno()], [], [], CHECK_INTERVAL)
            for slot in dict.fromkeys(files[file] for file in ready if file in files):
                for message in slot.messages():
                    yield from self._handle(slot, message)
            self._check_limits()

    def close(self) -> None:
        """Stop all processes at once, and discard unfinished parts."""
        ending = [pid for slot in self.slots for pid in slot.processes()]
        for slot in self.slots:
            if slot.task is not None:
                discard(_part(slot.task))
            slot.close()
        self.slots.clear()
        wait_for_end(ending, EXIT_TIMEOUT)

    def _busy(self) -> list[WorkerSlot]:
        return [slot for slot in self.slots if slot.task is not None]

    def _assign(self) -> None:
        """Start tasks in free slots; an exclusive task waits until all slots are free."""
        if self.exclusive_tasks:
            if not self._busy():
                self._start(self.slots[0], self.exclusive_tasks.popleft())
            return
        for slot in self.slots:
            if slot.task is None and self.pending:
                self._start(slot, self._next_task(slot))

    def _next_task(self, slot: WorkerSlot) -> Task:
        """Prefer a task for the slot's process, of a navigator that no other slot runs.

        A process takes tasks with drivers after those without, but not the reverse.
        """
        others = {other.process_key[0] for other in self.slots if other.task is not None}

        def rank(task: Task) -> tuple[bool, bool, bool]:
            navigator, drivers = task.process_key
            return not slot.may_run(task), navigator in others, drivers != ""

        place = min(enumerate(self.pending), key=lambda one: rank(one[1]))[0]
        task = self.pending[place]
        del self.pending[place]
        return task

    def _start(self, slot: WorkerSlot, task: Task) -> None:
        self.progress.start(id(slot), task.load)
        slot.start(task)

    def _handle(self, slot: WorkerSlot, message: Any) -> Iterator[Finished]:
        if isinstance(message, TaskFailure):
            self._fail(slot, message)
        elif isinstance(message, int):
            self.progress.advance(message)
        else:
            task = slot.finish()
            self.progress.finish(id(slot))
            yield task, message

    def _check_limits(self) -> None:
        """Stop every process that exceeds a limit."""
        now = monotonic()
        elapsed = now - self.checked_at
        if elapsed < CHECK_INTERVAL:
            return
        self.checked_at = now
        for slot in self.slots:
            failure = slot.check_limits(elapsed)
            if failure is not None:
                self._fail(slot, failure)
        self._look()

    def _look(self) -> None:
        """Show the activity of the first worker that has one."""
        activities = (slot.activity() for slot in self.slots)
        self.progress.look(next(filter(None, activities), ""))

    def _fail(self, slot: WorkerSlot, failure: TaskFailure) -> None:
        """Repeat a failed task seed by seed, and charge the navigator with single seeds only."""
        task = slot.abort()
        discard(_part(task))
        self.progress.advance(-slot.reported)
        self.progress.drop(id(slot))
        if failure.internal or task.forced_failure:  # no navigator can have caused it
            raise failure.error()
        if failure.error_name == "StoreError" and not _has_space(task):
            raise failure.error()
        queue = self.exclusive_tasks if failure.killed_externally else self.pending
        if len(task.seeds) > 1:
            exclusive = failure.killed_externally
            singles = [replace(each, exclusive=exclusive) for each in task.one_by_one()]
            queue.extendleft(reversed(singles))
        elif not failure.new_process or (failure.killed_externally and not task.exclusive):
            queue.appendleft(replace(task, new_process=True, exclusive=failure.killed_externally))
        else:
            reason = f"the navigator's process {failure.cause}"
            self.pending.appendleft(replace(task, forced_failure=reason))


def _has_space(task: Task) -> bool:
    """Whether this process can write to the folder in which a worker could not."""
    try:
        with TemporaryFile(dir=task.folder) as file:
            file.write(bytes(_MIN_FREE_BYTES))
            file.flush()
            os.fsync(file.fileno())
    except OSError:
        return False
    return True


def _part(task: Task) -> Part:
    return Part(task.folder, task.first, task.stop)
