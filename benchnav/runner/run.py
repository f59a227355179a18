"""Executes a suite into a run folder."""

from collections import Counter
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, field, replace

from benchnav.errors import UsageError
from benchnav.isolation import process_pool
from benchnav.plugins import METRICS
from benchnav.runner.execute.executor import Finished, execute
from benchnav.runner.execute.in_process import bound_here, refuse_edited, refuse_limits_here
from benchnav.runner.execute.progress import Progress
from benchnav.runner.plan.job import Job
from benchnav.runner.plan.limits import Limits
from benchnav.runner.plan.prepare import planned, refuse_limits, start
from benchnav.runner.plan.renewal import Renewal
from benchnav.runner.plan.shard import Shard
from benchnav.runner.plan.suite import Suite
from benchnav.runner.plan.task import Outcome, Task, chunks, joined_chunks
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.run_path import RunPath, run_path
from benchnav.store.runs.scenario_files import keep_files
from benchnav.system.temporary_folder import drop_abandoned
from benchnav.threads import core_count

Executor = Callable[[Sequence[Task], int | None, Progress, Limits], Generator[Finished, None, None]]
"""(tasks, workers or None for all there are, progress, limits) → finished tasks, stored."""


@dataclass
class Summary:
    """The result of a run; it is filled during the run, and valid after an interruption."""

    total: int = 0  # episodes of the suite, without n/a cells
    found: int = 0  # of these, on disk before the run began
    stored: int = 0  # of these, on disk now
    redraws: int = 0  # draws of worlds that this execution rejected as unsolvable
    not_applicable: list[tuple[Job, str]] = field(default_factory=list)
    failures: Counter[tuple[str, str]] = field(default_factory=Counter)  # (navigator, reason)
    unled: Counter[tuple[str, str, str]] = field(default_factory=Counter)
    """Worlds by (navigator, scenario, team) in which a leader succeeded in no rehearsal."""
    remarks: Counter[tuple[str, str, str]] = field(default_factory=Counter)
    """Worlds by (navigator, scenario, remark of the navigator)."""
    missing: Counter[tuple[str, str]] = field(default_factory=Counter)
    """Values by (metric, reason of its failure)."""
    older: int = 0  # stored episodes of older code, which must be replaced
    replaced: Counter[str] = field(default_factory=Counter)  # of these, the replaced ones, by label
    in_process: tuple[str, ...] = ()  # labels that ran here, as only this process knows them
    tracebacks: dict[tuple[str, str], str] = field(default_factory=dict)
    """One traceback for each (navigator, kind of reason)."""

    def count(self, task: Task, outcome: Outcome) -> None:
        """Add the outcome of a finished task."""
        self.stored += outcome.episodes
        self.redraws += outcome.redraws
        label = task.job.contestant.label
        self.failures.update((label, reason) for _, reason in outcome.failures)
        scenario = task.job.scenario.identity
        self.unled.update((label, scenario, team) for _, team in outcome.unled)
        self.remarks.update((label, scenario, text) for _, text in outcome.remarks)
        self.missing.update(outcome.missing)
        self.tracebacks |= {(label, kind): text for kind, text in outcome.tracebacks.items()}
        if outcome.missing_extra:
            self.total -= len(task.seeds)
            if all(job != task.job for job, _ in self.not_applicable):
                self.not_applicable.append((task.job, outcome.missing_extra))


def default_workers() -> int:
    """Return the number of cores that this process may use."""
    return core_count()


def run_suite(
    suite: Suite,
    out: RunPath,
    *,
    workers: int | None = None,
    timeout: float | None = None,
    memory: float | None = None,
    shard: Shard | None = None,
    again: bool = False,
    executor: Executor | None = None,
    progress: Progress | None = None,
    summary: Summary | None = None,
) -> Summary:
    """Run the missing episodes; afterwards ``out`` holds the whole suite.

    Seeds that a run in ``out`` does not have are added to it.

    Args:
        suite: the suite to run.
        out: the run folder; missing, empty, or one of the same suite, resumed or extended.
        workers: the number of processes; None: one for each core; 0: run in this process,
            without limits. A plugin that is registered only in this process always runs in it.
        timeout: [s] that a call of a navigator may last; None: as in ``out``, or as in `Limits`.
        memory: [GB] that a worker may hold; None: as for ``timeout``.
        shard: the share to run; None: the whole suite.
        again: run the episodes of older code again. The old episodes of a navigator are replaced
            when all its new ones are stored; a run that stops earlier keeps the old ones, and
            can be resumed.
        executor: the function that runs the tasks; None: worker processes of this machine.
        progress: is notified of every finished episode; None: no progress.
        summary: is filled during the run; None: a new one.

    Raises:
        UsageError: no metric is registered, a limit cannot be enforced, or ``out`` is no path.
        RunConflictError: ``out`` holds a run of another suite, salt or limit, or files that are no
            run, or episodes of older code (without ``again``), or another process writes to it.
        StoreError: the disk cannot be written, or a stored part is damaged.
        UnsolvableError: a scenario cannot be drawn.
    """
    _refuse_without_metrics()
    out = run_path(out)
    reporter = progress if progress is not None else Progress()
    summary = summary if summary is not None else Summary()
    jobs = list(suite.jobs())
    if executor is None:
        refuse_limits(workers, timeout, memory)
    here = jobs if workers == 0 else bound_here(jobs, elsewhere=executor is not None)
    refuse_edited(here)
    if workers != 0:
        refuse_limits_here(here, (timeout, memory) != (None, None))
        evaluated = [job for job in here if not job.undisturbed]
        summary.in_process = tuple(dict.fromkeys(job.contestant.label for job in evaluated))
    wanted = _wanted(suite, jobs, shard)
    manifest = planned(suite, jobs, wanted, shard)
    begun, limits = start(suite, out, manifest, timeout, memory)
    with begun.writing() as folder:
        for scenario in suite.scenarios:
            keep_files(folder.path, scenario.named_files())
        renewal = Renewal.of(folder, manifest)
        if not again:
            renewal.refuse(folder)
        summary.older = renewal.episodes
        reasons = {job.key: job.reason for job in jobs}
        if shard is None:
            folder = folder.extend(suite.seeds)
        folder = renewal.begin(folder.amend(reasons))  # reasons change if packages were installed
        target = renewal.target(folder)
        folder.drop_others(target)
        count = default_workers() if workers is None else workers
        tasks = _tasks(suite, target, jobs, wanted, summary, None if executor else count)
        keys = {job.key for job in here}
        unguarded = [t.job for t in tasks if t.job.key in keys and not t.job.undisturbed]
        folder = folder.unguard(job.contestant.label for job in unguarded)
        reporter.begin(summary.total, summary.stored)
        reporter.expect(task.load for task in tasks)
        try:
            with closing(_finished(tasks, here, workers, reporter, limits, executor)) as finished:
                for task, outcome in finished:
                    summary.count(task, outcome)
        finally:
            reporter.end()
            process_pool.stop_all()
            with suppress(OSError):
                drop_abandoned()  # folders of workers that were killed
            not_run = {job.key: why for job, why in summary.not_applicable}
            summary.replaced.update(renewal.finish(folder.amend(reasons | not_run)))
    return summary


def _finished(
    tasks: Sequence[Task], here: Sequence[Job], workers: int | None, progress: Progress,
    limits: Limits, executor: Executor | None,
) -> Generator[Finished, None, None]:  # fmt: skip
    """Run all tasks; of those of undisturbed worlds and of others, the cells ``here`` run last.

    The cells ``here`` run in this process. Undisturbed episodes are stored before others are
    measured.
    """
    keys = {job.key for job in here}
    for undisturbed in (True, False):
        group = [task for task in tasks if task.job.undisturbed == undisturbed]
        mine = [task for task in group if task.job.key in keys]
        away = [task for task in group if task.job.key not in keys]
        for chosen, run, count in ((away, executor or _locally, workers), (mine, _locally, 0)):
            if chosen:
                with closing(run(chosen, count, progress, limits)) as finished:
                    yield from finished


def _locally(
    tasks: Sequence[Task], workers: int | None, progress: Progress, limits: Limits
) -> Generator[Finished, None, None]:
    return execute(tasks, default_workers() if workers is None else workers, progress, limits)


def _wanted(suite: Suite, jobs: list[Job], shard: Shard | None) -> dict[str, set[int]]:
    """Return the seeds to run of each cell."""
    if shard is not None:
        return shard.seeds(jobs, suite.seeds)
    return {job.key: set(suite.seeds) for job in jobs}


def _tasks(
    suite: Suite, folder: RunFolder, jobs: list[Job], wanted: Mapping[str, set[int]],
    summary: Summary, workers: int | None,
) -> list[Task]:  # fmt: skip
    """Return the missing tasks, the longest first; ``workers`` is None if it is unknown."""
    found: list[tuple[Task, set[int]]] = []
    for job in jobs:
        if job.reason:
            summary.not_applicable.append((job, job.reason))
            continue
        seeds = wanted.get(job.key, set())
        missing = seeds - folder.done(job.key)
        summary.total += len(seeds)
        summary.stored += len(seeds) - len(missing)
        other = "" if job.undisturbed else folder.undisturbed_key(job.scenario.identity)
        task = Task(
            job, folder.cell(job.key), 0, 0, salt=folder.manifest.salt, probe=suite.seeds.start,
            undisturbed=folder.cell(other) if other else None,
        )  # fmt: skip
        found.append((task, missing))
    summary.found = summary.stored
    total = sum(len(missing) for _, missing in found)
    joined = 1 if workers is None else joined_chunks(total, workers)
    tasks = [
        replace(task, first=first, stop=stop)
        for task, missing in found
        for first, stop in chunks(missing, task.job.effort, joined)
    ]
    return sorted(tasks, key=lambda task: -task.job.effort * len(task.seeds))


def _refuse_without_metrics() -> None:
    if not METRICS.names():
        raise UsageError(
            "Metrics must be registered, or nothing would be measured. There are none: the"
            " installed metadata is stale. Install benchnav again (pip install -e . in a checkout)."
        )
