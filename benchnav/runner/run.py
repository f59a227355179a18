"""Executes a suite into a run folder."""

from collections import Counter
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from benchnav.errors import RunConflictError, UsageError
from benchnav.isolation import pool
from benchnav.plugins import METRICS
from benchnav.runner.executor import execute
from benchnav.runner.generators import draw_salt
from benchnav.runner.limits import Limits
from benchnav.runner.process_tree import tells_memory
from benchnav.runner.progress import Progress
from benchnav.runner.suite import Cell, Suite
from benchnav.runner.task import Outcome, Task, chunks
from benchnav.store.manifest import Manifest
from benchnav.store.run_folder import RunFolder
from benchnav.store.scenario_files import keep_files
from benchnav.threads import core_count


@dataclass
class Summary:
    """What a run did; filled while it goes on, so that an interrupted one can say how far."""

    total: int = 0  # episodes of the suite, n/a cells left out
    found: int = 0  # of these, on disk before it began
    stored: int = 0  # of these, on disk now
    redraws: int = 0  # draws of worlds that were thrown away as unsolvable, in this execution
    not_applicable: list[tuple[Cell, str]] = field(default_factory=list)
    failures: Counter[tuple[str, str]] = field(default_factory=Counter)  # (navigator, reason)
    unled: Counter[tuple[str, str, str]] = field(default_factory=Counter)
    """Worlds by (navigator, scenario, team) in which a leader succeeded in no rehearsal."""
    remarks: Counter[tuple[str, str, str]] = field(default_factory=Counter)
    """Worlds by (navigator, scenario, what it tells of them)."""
    missing: Counter[tuple[str, str]] = field(default_factory=Counter)
    """Values by (metric, why it failed)."""

    def count(self, task: Task, outcome: Outcome) -> None:
        """A task is finished."""
        self.stored += outcome.episodes
        self.redraws += outcome.redraws
        label = task.cell.entry.label
        self.failures.update((label, reason) for _, reason in outcome.failures)
        scenario = task.cell.scenario.identity
        self.unled.update((label, scenario, team) for _, team in outcome.unled)
        self.remarks.update((label, scenario, text) for _, text in outcome.remarks)
        self.missing.update(outcome.missing)
        if outcome.lacks:
            self.total -= len(task.seeds)
            if all(cell != task.cell for cell, _ in self.not_applicable):
                self.not_applicable.append((task.cell, outcome.lacks))


def default_workers() -> int:
    """The cores that this process may use."""
    return core_count()


def run_suite(
    suite: Suite,
    out: Path,
    *,
    workers: int | None = None,
    timeout: float | None = None,
    memory: float | None = None,
    progress: Progress | None = None,
    summary: Summary | None = None,
) -> Summary:
    """Run what is not stored yet; afterwards ``out`` holds the whole suite.

    Args:
        suite: what to run.
        out: the run folder; missing, empty, or one of the same suite (resumed).
        workers: processes; None: as many as there are cores; 0: in this process, where nothing
            is limited.
        timeout: [s] that a call of a navigator may last; None: as in ``out``, or as in `Limits`.
        memory: [GB] that a worker may hold; None: likewise.
        progress: who is told; None: nobody.
        summary: filled while the run goes on; None: a new one.

    Raises:
        UsageError: no metric is registered, or a limit cannot be kept.
        RunConflictError: ``out`` holds another suite, salt, limit or thing, or another process
            writes it.
        StoreError: the disk refuses, or a stored part is damaged.
        UnsolvableError: a scenario cannot be drawn.
    """
    _refuse_without_metrics()
    told = progress if progress is not None else Progress()
    summary = summary if summary is not None else Summary()
    cells = list(suite.cells())
    count = _count(workers)
    _refuse_limits(count, timeout, memory)
    folder, limits = _start(suite, out, cells, timeout, memory)
    with folder.writing():
        reasons = {cell.key: cell.reason for cell in cells}
        folder = folder.amend(reasons)  # what was not installed then may be now
        tasks = _tasks(suite, folder, cells, summary)
        told.begin(summary.total, summary.stored)
        try:
            with closing(execute(tasks, count, told, limits)) as finished:
                for task, outcome in finished:
                    summary.count(task, outcome)
        finally:
            told.end()
            pool.dismiss()
            folder.amend(reasons | {cell.key: why for cell, why in summary.not_applicable})
    return summary


def _tasks(suite: Suite, folder: RunFolder, cells: list[Cell], summary: Summary) -> list[Task]:
    """What is missing, the longest first."""
    tasks = []
    for cell in cells:
        if cell.reason:
            summary.not_applicable.append((cell, cell.reason))
            continue
        missing = set(suite.seeds) - folder.done(cell.key)
        summary.total += len(suite.seeds)
        summary.stored += len(suite.seeds) - len(missing)
        task = Task(
            cell, folder.cell(cell.key), 0, 0, salt=folder.manifest.salt, probe=suite.seeds.start
        )
        for first, stop in chunks(missing, cell.effort):
            tasks.append(replace(task, first=first, stop=stop))
    summary.found = summary.stored
    return sorted(tasks, key=lambda task: -task.cell.effort * len(task.seeds))


def _refuse_without_metrics() -> None:
    if not METRICS.names():
        raise UsageError(
            "Metrics must be registered, or nothing would be measured. There are none: the"
            " installed metadata is stale. Install benchnav again (pip install -e . in a checkout)."
        )


def _refuse_limits(workers: int, timeout: float | None, memory: float | None) -> None:
    if workers == 0 and (timeout, memory) != (None, None):
        raise UsageError(
            "A limit must have a worker process to hold in. Got --workers 0, which has none."
        )
    if memory is not None and not tells_memory():
        raise UsageError(
            "--memory must stand on a system that tells how much memory a process holds."
            " This one does not; leave it out."
        )


def _start(
    suite: Suite, out: Path, cells: list[Cell], timeout: float | None, memory: float | None
) -> tuple[RunFolder, Limits]:
    said = tuple(_said(c) for c in cells)
    asked = _limits(Limits(), timeout, memory)
    salt = suite.salt or draw_salt()
    folder = RunFolder.start(out, Manifest(suite.resolved(), said, salt, asked.said()))
    for scenario in suite.scenarios:
        keep_files(folder.path, scenario.named_files())
    held = folder.manifest.salt
    if suite.salt not in ("", held):
        raise RunConflictError(
            f"The salt must be that of the run in {folder.path}, {held}. Got {suite.salt} instead."
            " Leave --salt out to go on there, or give another --out."
        )
    limits = Limits.of(folder.manifest.limits)
    if _limits(limits, timeout, memory) != limits:
        raise RunConflictError(
            f"The limits must be those of the run in {folder.path}, {limits}. Got"
            f" {_limits(limits, timeout, memory)} instead. Leave --timeout and --memory out to go"
            " on there, or give another --out."
        )
    return folder, limits


def _limits(otherwise: Limits, timeout: float | None, memory: float | None) -> Limits:
    try:
        return Limits(
            otherwise.timeout if timeout is None else timeout,
            otherwise.memory if memory is None else memory,
        )
    except ValueError as error:
        raise UsageError(f"The limit {error}.") from None


def _said(cell: Cell) -> dict[str, Any]:
    return {
        "key": cell.key,
        "scenario": cell.scenario.identity,
        "track": cell.track,
        "navigator": cell.entry.label,
        "reason": cell.reason,
        **({"also": list(cell.also)} if cell.also else {}),
    }


def _count(workers: int | None) -> int:
    return default_workers() if workers is None else workers
