"""The execution of tasks on a Ray cluster: bit-equal parts to those of the local executor.

Each core of the cluster runs a `RayWorker` actor. Parts return through Ray's object store, so no
shared folder is needed. If a machine fails, the tasks of its actors are given to other actors.
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
from benchnav.runner.ray.ray_worker import Delivery, RayWorker, Refusal
from benchnav.store.parts.part import FILES, SEAL, Part, parts_of
from benchnav.store.parts.part_writer import receive
from benchnav.store.runs.manifest import versions
from benchnav.threads import core_count

MAX_LOSSES = 5  # machines that may fail during one task
EXIT_TIMEOUT = 5.0  # [s] for actors to end
START_TIMEOUT = 600.0  # [s] without any usable actor


def execute_on_ray(
    tasks: Sequence[Task],
    workers: int | None,
    progress: Progress,
    limits: Limits,
    address: str = "",
) -> Generator[Finished, None, None]:
    """Run tasks like `benchnav.runner.execute.executor.execute`, on a Ray cluster.

    Args:
        tasks: in the order in which they start.
        workers: the number of actors; None: one for each core of the cluster.
        progress: is updated after every stored task.
        limits: of time and memory, for each worker process.
        address: of the cluster, as Ray writes them (``auto``, ``host:6379``, ``ray://host:10001``);
            "": a cluster that is started on this machine and ends with the run.

    Raises:
        MissingExtraError: Ray is not installed.
        BenchnavError: there is no cluster at that address, a machine has other versions, or a
            task raised it. Every task that was yielded is stored.
    """
    with _cluster(address, workers) as ray:
        cores = int(ray.cluster_resources().get("CPU", 0))
        jobs = _RayJobs(ray, progress, limits, deque(tasks))
        try:
            yield from jobs.run(min(workers or max(cores, 1), len(tasks)))
        finally:
            jobs.close()


@dataclass
class _RayJobs:
    ray: Any
    progress: Progress
    limits: Limits
    pending: deque[Task]
    waiting: dict[Any, tuple[Any, Task | None]] = field(default_factory=dict)
    """Pending results → (actor, its task; None while it reports its versions)."""
    idle: list[Any] = field(default_factory=list)
    losses: Counter[tuple[str, int]] = field(default_factory=Counter)
    files: dict[str, Any] = field(default_factory=dict)  # of scenarios, by hash

    def run(self, actors: int) -> Iterator[Finished]:
        for _ in range(actors):
            self._start_actor()
        active = monotonic()
        while self.pending or any(task for _, task in self.waiting.values()):
            ready, _ = self.ray.wait(list(self.waiting), num_returns=1, timeout=5.0)
            busy = any(task for _, task in self.waiting.values())
            active = monotonic() if ready or busy else active
            if monotonic() - active > START_TIMEOUT:
                raise BenchnavError(
                    f"No usable Ray worker appeared within {START_TIMEOUT:g} s. All stored episodes"
                    " are kept; the same suite continues in the same folder."
                )
            for result in ready:
                yield from self._receive(result)

    def close(self) -> None:
        """Stop all actors, and discard unfinished parts."""
        ending = [actor.close.remote() for actor in self.idle]
        if ending:
            self.ray.wait(ending, num_returns=len(ending), timeout=EXIT_TIMEOUT)
        for actor in [*self.idle, *(actor for actor, _ in self.waiting.values())]:
            self.ray.kill(actor)

    def _start_actor(self) -> None:
        path = [*sys.path, str(current_folder())]  # it may hold a navigator: module:Class
        actor = self.ray.remote(num_cpus=1)(RayWorker).remote(self.limits, path, registrations())
        self.waiting[actor.versions.remote()] = actor, None

    def _receive(self, result: Any) -> Iterator[Finished]:
        actor, task = self.waiting.pop(result)
        try:
            answer = self.ray.get(result)
        except self.ray.exceptions.RayTaskError as error:
            raise RuntimeError(f"A Ray actor crashed:\n{error}") from error
        except self.ray.exceptions.RayError as error:
            self._replace(actor, task, error)
            return
        if task is None:
            _refuse_other_versions(answer)
        elif isinstance(answer, Refusal):
            raise named(answer.name, answer.text)
        else:
            self.progress.finish(id(actor))
            yield from map(self._store, answer)
        if self.pending:
            self._assign(actor)
        else:
            self.idle.append(actor)

    def _assign(self, actor: Any) -> None:
        task = self.pending.popleft()
        self.progress.start(id(actor), task.load)
        result = actor.work.remote(task, self._files(task), undisturbed_files(task))
        self.waiting[result] = actor, task

    def _store(self, delivery: Delivery) -> Finished:
        task = delivery.task
        if delivery.files:
            receive(Part(task.folder, task.first, task.stop), delivery.files)
        self.progress.advance(delivery.outcome.episodes)
        return task, delivery.outcome

    def _replace(self, actor: Any, task: Task | None, error: Exception) -> None:
        """Give the task to another actor: the machine of this one failed or cannot be reached."""
        self.ray.kill(actor)
        if task is not None:
            self.progress.drop(id(actor))
            key = task.job.key, task.first
            self.losses[key] += 1
            if self.losses[key] > MAX_LOSSES:
                raise BenchnavError(
                    f"{MAX_LOSSES + 1} machines failed while they ran seeds {task.first} to"
                    f" {task.stop - 1} of {task.job.key}. Message of Ray: {error}"
                )
            self.pending.appendleft(task)
        if self.pending and self.idle:  # a new actor may not get a core
            self._assign(self.idle.pop())
        else:
            self._start_actor()

    def _files(self, task: Task) -> Any:
        """Return the files of its scenario, by name; each is sent to a machine once."""
        scenario = task.job.scenario
        if scenario.hash not in self.files:
            found = {name: path.read_bytes() for name, path in scenario.named_files().items()}
            self.files[scenario.hash] = self.ray.put(found)
        return self.files[scenario.hash]


def undisturbed_files(task: Task) -> dict[str, bytes]:
    """Return the files of the undisturbed episodes of a task's worlds, by name."""
    if task.undisturbed is None:
        return {}
    seeds = set(task.seeds)
    parts = [part for part in parts_of(task.undisturbed) if seeds & set(part.seeds)]
    paths = [part.path(suffix) for part in parts for suffix in (*FILES, SEAL)]
    return {path.name: path.read_bytes() for path in paths if path.exists()}


def _refuse_other_versions(there: Mapping[str, str]) -> None:
    here = versions()
    names = sorted(n for n in {*here, *there} if here.get(n) != there.get(n))
    if names:
        found = ", ".join(f"{n} {there.get(n, 'none')} for {here.get(n, 'none')}" for n in names)
        raise BenchnavError(
            f"All machines of a cluster must have the versions of this one. One has {found}."
        )


@contextmanager
def _cluster(address: str, workers: int | None) -> Iterator[Any]:
    """Yield a connected Ray; a connection that existed before stays open."""
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    os.environ.setdefault("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")
    try:
        import ray
    except ImportError:
        raise MissingExtraError("The executor 'ray'", "ray") from None
    if ray.is_initialized():
        yield ray
        return
    options: dict[str, Any] = {"log_to_driver": False, "logging_level": "ERROR"}
    if not address:
        options |= {"num_cpus": workers or core_count(), "include_dashboard": False}
    try:
        ray.init(address or "local", **options)
    except (ConnectionError, RuntimeError, ValueError, TimeoutError) as error:
        where = repr(address) if address else "this machine"
        raise BenchnavError(
            f"There is no Ray cluster at {where}. Message of Ray: {error}"
        ) from error
    try:
        yield ray
    finally:
        ray.shutdown()
