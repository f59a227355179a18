"""Executes tasks on a Ray cluster: the same parts as the local executor, and the same bits.

Each core of the cluster has a `Foreman`. Parts travel back through Ray's object store, so
that no folder is shared. A machine that dies takes its foremen with it; what they were
at work on is given to others.
"""

import os
import sys
from collections import Counter, deque
from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import monotonic
from typing import Any

from benchnav.errors import BenchnavError, MissingExtraError, named
from benchnav.named_module import current_folder
from benchnav.plugins import registrations
from benchnav.runner.execute.executor import Finished
from benchnav.runner.execute.progress import Progress
from benchnav.runner.plan.limits import Limits
from benchnav.runner.plan.task import Task
from benchnav.runner.ray.ray_worker import Delivery, Foreman, Refusal
from benchnav.store.parts.part import Part
from benchnav.store.parts.part_writer import receive
from benchnav.store.runs.manifest import versions
from benchnav.threads import core_count

LOSSES = 5  # machines that may die over one task
GOODBYE = 5.0  # [s] for foremen to leave
PATIENCE = 600.0  # [s] without any foreman


def execute_on_ray(
    tasks: Sequence[Task],
    workers: int | None,
    progress: Progress,
    limits: Limits,
    address: str = "",
) -> Generator[Finished, None, None]:
    """As `benchnav.runner.execute.executor.execute`, on a Ray cluster.

    Args:
        tasks: in the order in which they are begun.
        workers: foremen; None: one for each core of the cluster.
        progress: is told of every stored task.
        limits: what a navigator may take of its worker.
        address: of the cluster, as Ray writes them (``auto``, ``host:6379``, ``ray://host:10001``);
            "": one that is started on this machine, and ends with the run.

    Raises:
        MissingExtraError: Ray is not installed.
        BenchnavError: no cluster at that address; a machine has other versions; what a task
            raised. Everything that was yielded is stored.
    """
    with _cluster(address, workers) as ray:
        cores = int(ray.cluster_resources().get("CPU", 0))
        site = _Site(ray, progress, limits, deque(tasks))
        try:
            yield from site.run(min(workers or max(cores, 1), len(tasks)))
        finally:
            site.dismiss()


@dataclass
class _Site:
    ray: Any
    progress: Progress
    limits: Limits
    pending: deque[Task]
    waiting: dict[Any, tuple[Any, Task | None]] = field(default_factory=dict)
    """What is to come → (foreman, what it works on; None: it introduces itself)."""
    idle: list[Any] = field(default_factory=list)
    losses: Counter[tuple[str, int]] = field(default_factory=Counter)
    files: dict[str, Any] = field(default_factory=dict)  # of scenarios, by hash

    def run(self, foremen: int) -> Iterator[Finished]:
        for _ in range(foremen):
            self._hire()
        heard = monotonic()
        while self.pending or any(task for _, task in self.waiting.values()):
            ready, _ = self.ray.wait(list(self.waiting), num_returns=1, timeout=5.0)
            busy = any(task for _, task in self.waiting.values())
            heard = monotonic() if ready or busy else heard
            if monotonic() - heard > PATIENCE:
                raise BenchnavError(
                    f"A Ray cluster must have a machine that works. None came in {PATIENCE:g} s;"
                    " what is stored is safe, and the same --out goes on from there."
                )
            for promise in ready:
                yield from self._heed(promise)

    def dismiss(self) -> None:
        """Stop everybody; unfinished parts are thrown away."""
        leaving = [foreman.leave.remote() for foreman in self.idle]
        if leaving:
            self.ray.wait(leaving, num_returns=len(leaving), timeout=GOODBYE)
        for foreman in [*self.idle, *(foreman for foreman, _ in self.waiting.values())]:
            self.ray.kill(foreman)

    def _hire(self) -> None:
        path = [*sys.path, str(current_folder())]  # a navigator may lie there: module:Class
        foreman = self.ray.remote(num_cpus=1)(Foreman).remote(self.limits, path, registrations())
        self.waiting[foreman.introduce.remote()] = foreman, None

    def _heed(self, promise: Any) -> Iterator[Finished]:
        foreman, task = self.waiting.pop(promise)
        try:
            answer = self.ray.get(promise)
        except self.ray.exceptions.RayTaskError as error:
            raise RuntimeError(f"A foreman crashed:\n{error}") from error
        except self.ray.exceptions.RayError as error:
            self._lose(foreman, task, error)
            return
        if task is None:
            _refuse_other_versions(answer)
        elif isinstance(answer, Refusal):
            raise named(answer.name, answer.text)
        else:
            self.progress.finish(id(foreman))
            yield from map(self._store, answer)
        if self.pending:
            self._assign(foreman)
        else:
            self.idle.append(foreman)

    def _assign(self, foreman: Any) -> None:
        task = self.pending.popleft()
        self.progress.start(id(foreman), task.load)
        promise = foreman.work.remote(task, self._files(task))
        self.waiting[promise] = foreman, task

    def _store(self, delivery: Delivery) -> Finished:
        task = delivery.task
        if delivery.files:
            receive(Part(task.folder, task.first, task.stop), delivery.files)
        self.progress.advance(delivery.outcome.episodes)
        return task, delivery.outcome

    def _lose(self, foreman: Any, task: Task | None, error: Exception) -> None:
        """Its machine is gone, or cannot be reached: nobody is charged."""
        self.ray.kill(foreman)
        if task is not None:
            self.progress.drop(id(foreman))
            key = task.cell.key, task.first
            self.losses[key] += 1
            if self.losses[key] > LOSSES:
                raise BenchnavError(
                    f"A machine must live as long as a task lasts. {LOSSES + 1} died over seeds"
                    f" {task.first} to {task.stop - 1} of {task.cell.key}. Ray says: {error}"
                )
            self.pending.appendleft(task)
        if self.pending and self.idle:  # a new one may have no core to begin on
            self._assign(self.idle.pop())
        else:
            self._hire()

    def _files(self, task: Task) -> Any:
        """Of its scenario, by name; each goes to a machine once."""
        scenario = task.cell.scenario
        if scenario.hash not in self.files:
            found = {name: path.read_bytes() for name, path in scenario.named_files().items()}
            self.files[scenario.hash] = self.ray.put(found)
        return self.files[scenario.hash]


def _refuse_other_versions(there: Mapping[str, str]) -> None:
    here = versions()
    names = sorted(n for n in {*here, *there} if here.get(n) != there.get(n))
    if names:
        told = ", ".join(f"{n} {there.get(n, 'none')} for {here.get(n, 'none')}" for n in names)
        raise BenchnavError(
            f"All machines of a cluster must have the versions of this one. One has {told}."
        )


@contextmanager
def _cluster(address: str, workers: int | None) -> Iterator[Any]:
    """Ray, connected; one that was connected before stays so."""
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    os.environ.setdefault("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")
    try:
        import ray
    except ImportError:
        raise MissingExtraError("The executor 'ray'", "ray") from None
    if ray.is_initialized():
        yield ray
        return
    told: dict[str, Any] = {"log_to_driver": False, "logging_level": "ERROR"}
    if not address:
        told |= {"num_cpus": workers or core_count(), "include_dashboard": False}
    try:
        ray.init(address or "local", **told)
    except (ConnectionError, RuntimeError, ValueError, TimeoutError) as error:
        where = repr(address) if address else "this machine"
        raise BenchnavError(f"A Ray cluster must be at {where}. Ray says: {error}") from error
    try:
        yield ray
    finally:
        ray.shutdown()
