"""Executes tasks in local worker processes, and survives what they do."""

import multiprocessing
import os
import signal
from collections import deque
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any

from benchnav.errors import BenchnavError
from benchnav.runner.progress import Progress
from benchnav.runner.task import Outcome, Task, work
from benchnav.runner.worker import ONE_THREAD, refused, serve

Finished = tuple[Task, Outcome]


def execute(
    tasks: Sequence[Task], workers: int, progress: Progress
) -> Generator[Finished, None, None]:
    """Run every task; yields each as it is stored, in no promised order.

    Args:
        tasks: in the order in which they are begun.
        workers: processes; 0 runs in this one.
        progress: is told of every finished episode.

    Raises:
        BenchnavError: what a task raised. Everything that was yielded is stored.

    Close it to dismiss the workers where it is not exhausted.
    """
    if workers == 0:
        for task in tasks:
            yield task, work(task, progress.advance)
        return
    crew = _Crew(deque(tasks), min(workers, len(tasks)), progress)
    try:
        yield from crew.run()
    finally:
        crew.dismiss()


@dataclass(eq=False)
class _Worker:
    process: BaseProcess
    pipe: "Connection[Any, Any]"
    task: Task | None = None
    ready: bool = False
    told: int = 0  # episodes of its task that it counted


@dataclass
class _Crew:
    pending: deque[Task]
    size: int
    progress: Progress
    workers: list[_Worker] = field(default_factory=list)

    def run(self) -> Iterator[Finished]:
        for _ in range(self.size):
            self._hire()
        while self.pending or any(w.task for w in self.workers):
            pipes = {worker.pipe: worker for worker in self.workers}
            for pipe in wait(list(pipes)):
                worker = pipes[pipe]  # type: ignore[index]
                try:
                    kind, content = worker.pipe.recv()
                except (EOFError, OSError):
                    self._bury(worker)
                    continue
                if kind == "done" and worker.task is not None:
                    yield worker.task, content
                self._heed(worker, kind, content)

    def dismiss(self) -> None:
        """Stop everybody at once; unfinished parts are thrown away."""
        for worker in self.workers:
            if worker.task is None and worker.ready:
                worker.pipe.close()  # it sees the end and leaves
            else:
                worker.process.terminate()
        for worker in self.workers:
            worker.process.join(2.0)
            if worker.process.is_alive():
                worker.process.kill()
                worker.process.join()
            worker.process.close()

    def _hire(self) -> None:
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=serve, args=(theirs,), daemon=True)
        with _environment(ONE_THREAD):
            process.start()
        theirs.close()
        self.workers.append(_Worker(process, ours))

    def _heed(self, worker: _Worker, kind: str, content: Any) -> None:
        if kind == "episodes":
            worker.told += content
            self.progress.advance(content)
            return
        if kind == "refused":
            raise refused(*content)
        if kind == "crashed":
            raise RuntimeError(f"A worker crashed:\n{content}")
        worker.ready, worker.task = True, None
        if self.pending:
            worker.task, worker.told = self.pending.popleft(), 0
            worker.pipe.send(worker.task)

    def _bury(self, worker: _Worker) -> None:
        """A worker died: find the one seed that kills it, and charge only that."""
        worker.process.join()
        self.workers.remove(worker)
        cause, task = _cause(worker.process.exitcode), worker.task
        if task is None or task.charge:
            raise BenchnavError(
                f"Worker processes must be able to start. One {cause} (stderr says why)."
                " A script must call this under `if __name__ == '__main__':`; 0 workers need none."
            )
        self.progress.advance(-worker.told)
        if len(task.seeds) > 1:
            self.pending.extendleft(reversed(task.alone()))
        else:
            self.pending.appendleft(replace(task, charge=f"the navigator's process {cause}"))
        self._hire()


def _cause(exitcode: int | None) -> str:
    if exitcode is not None and exitcode < 0:
        return f"was killed by {signal.Signals(-exitcode).name}"
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
