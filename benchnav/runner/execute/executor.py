"""Executes tasks in local processes, and survives what evaluated code does there.

Each core has a `Desk`: a worker, which plays the tasks of one entry and is replaced for the
next, and a measurer, in which no evaluated code runs. Who fails is charged only once a task of
one seed failed in a process of its own.
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
from benchnav.runner.execute.desk import Desk, Fault
from benchnav.runner.execute.progress import Progress
from benchnav.runner.plan.limits import Limits
from benchnav.runner.plan.task import Outcome, Task, work
from benchnav.store.parts.part import Part
from benchnav.store.parts.part_writer import discard

Finished = tuple[Task, Outcome]
_ROOM = 16 << 20  # bytes: more than the episodes of most tasks
GOODBYE = 2.0  # [s] for killed processes to let go of their files
LOOK = 0.1  # [s] between two looks at the workers' calls and memory


def execute(
    tasks: Sequence[Task], workers: int, progress: Progress, limits: Limits
) -> Generator[Finished, None, None]:
    """Run every task; yields each as it is stored, in no promised order.

    Args:
        tasks: in the order in which they are begun, but that a worker stays with an entry.
        workers: processes; 0 runs in this one, where nothing survives what a navigator does
            to its process, and no limit holds.
        progress: is told of every finished episode.
        limits: what a navigator may take.

    Raises:
        BenchnavError: what a task raised. Everything that was yielded is stored.

    Close it to dismiss the workers where it is not exhausted.
    """
    if workers == 0:
        for task in tasks:
            progress.start(0, task.load)
            outcome = work(task, progress.advance)
            progress.finish(0)
            yield task, outcome
        return
    crew = Crew(min(workers, len(tasks)), progress, limits)
    try:
        yield from crew.run(tasks)
    finally:
        crew.dismiss()


@dataclass
class Crew:
    """Desks that stay for one batch of tasks after the other."""

    size: int
    progress: Progress
    limits: Limits
    known: Iterable[Registration] | None = None  # None: what was registered in this process
    pending: deque[Task] = field(default_factory=deque)
    suspects: deque[Task] = field(default_factory=deque)
    """Tasks during which a process was killed by who knows whom: they run while no other does."""
    desks: list[Desk] = field(default_factory=list)
    looked: float = 0.0

    def run(self, tasks: Sequence[Task]) -> Iterator[Finished]:
        """Every task, as `execute`."""
        self.pending.extend(tasks)
        self.looked = monotonic()
        known = tuple(registrations() if self.known is None else self.known)
        while len(self.desks) < self.size:
            self.desks.append(Desk(self.limits, known))
        while self.pending or self.suspects or self._busy():
            self._assign()
            files = {file: desk for desk in self.desks for file in desk.files()}
            fork_server().look()
            ready, _, _ = select([*files, fork_server().fileno()], [], [], LOOK)
            for desk in dict.fromkeys(files[file] for file in ready if file in files):
                for message in desk.hear():
                    yield from self._heed(desk, message)
            self._look()

    def dismiss(self) -> None:
        """Stop everybody at once; unfinished parts are thrown away."""
        ending = [pid for desk in self.desks for pid in desk.processes()]
        for desk in self.desks:
            if desk.task is not None:
                discard(_part(desk.task))
            desk.close()
        self.desks.clear()
        wait_for_end(ending, GOODBYE)

    def _busy(self) -> list[Desk]:
        return [desk for desk in self.desks if desk.task is not None]

    def _assign(self) -> None:
        """Give tasks to who has none; a suspect is at work alone."""
        if self.suspects:
            if not self._busy():
                self._begin(self.desks[0], self.suspects.popleft())
            return
        for desk in self.desks:
            if desk.task is None and self.pending:
                self._begin(desk, self._chosen(desk))

    def _chosen(self, desk: Desk) -> Task:
        """Of who is there already; else of whom nobody works at; else the next."""
        others = {other.company for other in self.desks if other.task is not None}
        ranks = ((desk.company != t.company, t.company in others) for t in self.pending)
        place = min(enumerate(ranks), key=lambda one: one[1])[0]
        task = self.pending[place]
        del self.pending[place]
        return task

    def _begin(self, desk: Desk, task: Task) -> None:
        self.progress.start(id(desk), task.load)
        desk.play(task)

    def _heed(self, desk: Desk, message: Any) -> Iterator[Finished]:
        if isinstance(message, Fault):
            self._fail(desk, message)
        elif isinstance(message, int):
            self.progress.advance(message)
        else:
            task = desk.done()
            self.progress.finish(id(desk))
            yield task, message

    def _look(self) -> None:
        """Stop who is beyond a limit."""
        now = monotonic()
        elapsed = now - self.looked
        if elapsed < LOOK:
            return
        self.looked = now
        for desk in self.desks:
            fault = desk.look(elapsed)
            if fault is not None:
                self._fail(desk, fault)

    def _fail(self, desk: Desk, fault: Fault) -> None:
        """A task failed: find the one seed for which it does, and charge only that."""
        task = desk.drop()
        discard(_part(task))
        self.progress.advance(-desk.counted)
        self.progress.drop(id(desk))
        if fault.own or task.charge:  # no code of a navigator can have done it
            raise fault.error()
        if fault.name == "StoreError" and not _has_room(task):
            raise fault.error()
        queue = self.suspects if fault.sudden else self.pending
        if len(task.seeds) > 1:
            alone = [replace(each, suspect=fault.sudden) for each in task.alone()]
            queue.extendleft(reversed(alone))
        elif not fault.fresh or (fault.sudden and not task.suspect):
            queue.appendleft(replace(task, fresh=True, suspect=fault.sudden))
        else:
            charge = f"the navigator's process {fault.cause}"
            self.pending.appendleft(replace(task, charge=charge))


def _has_room(task: Task) -> bool:
    """Whether this process can write where a worker could not."""
    try:
        with TemporaryFile(dir=task.folder) as file:
            file.write(bytes(_ROOM))
            file.flush()
            os.fsync(file.fileno())
    except OSError:
        return False
    return True


def _part(task: Task) -> Part:
    return Part(task.folder, task.first, task.stop)
