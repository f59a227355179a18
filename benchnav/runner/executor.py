"""Executes tasks in local worker processes, and survives what they do."""

import multiprocessing
import os
import signal
from collections import deque
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from time import monotonic
from typing import Any

from benchnav.errors import BenchnavError, named
from benchnav.plugins import registrations
from benchnav.processes.process_tree import kill, resident
from benchnav.runner.limits import Limits
from benchnav.runner.progress import Progress
from benchnav.runner.task import Outcome, Task, work
from benchnav.runner.watch import SIZE, Watch
from benchnav.runner.worker import ONE_THREAD, serve

Finished = tuple[Task, Outcome]
LOOK = 0.1  # [s] between two looks at the workers' calls and memory


def execute(
    tasks: Sequence[Task], workers: int, progress: Progress, limits: Limits
) -> Generator[Finished, None, None]:
    """Run every task; yields each as it is stored, in no promised order.

    Args:
        tasks: in the order in which they are begun.
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


@dataclass(eq=False)
class _Worker:
    process: BaseProcess
    pipe: "Connection[Any, Any]"
    watch: Watch
    first: Task | None = None  # what it is to begin with
    task: Task | None = None
    ready: bool = False
    used: bool = False  # has finished a task
    told: int = 0  # episodes of its task that it counted
    broke: str = ""  # the limit for which it was stopped


@dataclass
class Crew:
    """Workers that stay for one batch of tasks after the other."""

    size: int
    progress: Progress
    limits: Limits
    pending: deque[Task] = field(default_factory=deque)
    workers: list[_Worker] = field(default_factory=list)
    looked: float = 0.0

    def run(self, tasks: Sequence[Task]) -> Iterator[Finished]:
        """Every task, as `execute`."""
        self.pending.extend(tasks)
        self.looked = monotonic()
        for worker in self.workers:
            self._assign(worker)
        for _ in range(self.size - len(self.workers)):
            self._hire()
        while self.pending or any(w.task or w.first for w in self.workers):
            pipes = {worker.pipe: worker for worker in self.workers}
            for pipe in wait(list(pipes), LOOK):
                worker = pipes[pipe]  # type: ignore[index]
                try:
                    kind, content = worker.pipe.recv()
                except (EOFError, OSError):
                    self._bury(worker)
                    continue
                if kind == "done" and worker.task is not None:
                    yield worker.task, content
                self._heed(worker, kind, content)
            self._look()

    def dismiss(self) -> None:
        """Stop everybody at once; unfinished parts are thrown away."""
        for worker in self.workers:
            if worker.task is None and worker.ready:
                worker.pipe.close()  # it sees the end and leaves
            elif worker.process.pid is not None:
                kill(worker.process.pid)
        for worker in self.workers:
            worker.process.join(2.0)
            if worker.process.is_alive():
                worker.process.kill()
                worker.process.join()
            worker.process.close()
        self.workers.clear()

    def _hire(self, first: Task | None = None) -> None:
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        notes = context.RawArray("d", SIZE)
        process = context.Process(target=serve, args=(theirs, notes, registrations()), daemon=True)
        with _environment(ONE_THREAD):
            process.start()
        theirs.close()
        self.workers.append(_Worker(process, ours, Watch(notes), first))

    def _heed(self, worker: _Worker, kind: str, content: Any) -> None:
        if kind == "episodes":
            worker.told += content
            self.progress.advance(content)
            return
        if kind == "refused":
            raise named(*content)
        if kind == "crashed":
            raise RuntimeError(f"A worker crashed:\n{content}")
        if worker.task is not None:
            self.progress.finish(worker.process.pid)
        worker.ready, worker.used, worker.task = True, kind == "done", None
        self._assign(worker)

    def _assign(self, worker: _Worker) -> None:
        if worker.broke or not (worker.first or self.pending):
            return
        task, worker.first = worker.first or self.pending.popleft(), None
        worker.task, worker.told = task, 0
        self.progress.start(worker.process.pid, task.load)
        with suppress(OSError):  # it died: its end is heard of next
            worker.pipe.send(task)

    def _look(self) -> None:
        """Stop the workers that are beyond a limit."""
        now = monotonic()
        elapsed = now - self.looked
        if elapsed < LOOK:
            return
        self.looked = now
        for worker in self.workers:
            worker.watch.look(elapsed)
            if worker.task is not None and not worker.broke:
                worker.broke = self._excess(worker)
                if worker.broke and worker.process.pid is not None:
                    kill(worker.process.pid)

    def _excess(self, worker: _Worker) -> str:
        limits, watch, pid = self.limits, worker.watch, worker.process.pid
        if watch.lasted > limits.timeout:
            return f"did not return from {watch.call()} within {limits.timeout:g} s"
        if pid is not None and resident(pid) > limits.memory * 1e9:
            return f"held more than {limits.memory:g} GB of memory"
        return ""

    def _bury(self, worker: _Worker) -> None:
        """A worker died: find the one seed that kills it, and charge only that."""
        worker.process.join()
        self.workers.remove(worker)
        cause, task = worker.broke or _cause(worker.process.exitcode), worker.task
        if not worker.ready or (task is not None and task.charge):
            raise BenchnavError(
                f"Worker processes must be able to start. One {cause} (stderr says why)."
                " A script must call this under `if __name__ == '__main__':`; 0 workers need none."
            )
        if task is None:
            self._hire()
            return
        self.progress.advance(-worker.told)
        self.progress.drop(worker.process.pid)
        if len(task.seeds) > 1:
            self.pending.extendleft(reversed(task.alone()))
            self._hire()
        elif worker.used:  # what ran before may have left a mark: once more in a fresh process
            self._hire(task)
        else:
            self.pending.appendleft(replace(task, charge=f"the navigator's process {cause}"))
            self._hire()


def _cause(exitcode: int | None) -> str:
    if exitcode is not None and exitcode < 0:
        known = {int(s): s.name for s in signal.Signals}
        return f"was killed by {known.get(-exitcode, f'signal {-exitcode}')}"
    return f"ended with exit status {exitcode}"


@contextmanager
def _environment(changes: dict[str, str]) -> Iterator[None]:
    before = {name: os.environ.get(name) for name in changes}
    os.environ.update(changes)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
