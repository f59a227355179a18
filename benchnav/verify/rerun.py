"""Run the navigators of a run again: only this detects replaced commands.

They run in separate workers, as in any run, and this process compares the files that the workers
write: it runs no evaluated code.
"""

import dataclasses
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from benchnav.episode.episode import Episode
from benchnav.errors import BenchnavError, CorruptPartError
from benchnav.generation.build import sensing_of
from benchnav.runner.execute.executor import execute
from benchnav.runner.execute.progress import Progress
from benchnav.runner.plan.contestant import Entry, Meeting
from benchnav.runner.plan.job import Cell
from benchnav.runner.plan.limits import Limits
from benchnav.runner.plan.task import Task, chunks
from benchnav.store.parts.part import FILES, SEAL, Part
from benchnav.store.runs.manifest import ISOLATED
from benchnav.store.runs.run_folder import RunFolder
from benchnav.text.visible import shortened
from benchnav.verify.finding import Report
from benchnav.verify.part_check import PartCheck
from benchnav.verify.untrusted_spec import is_by_module, is_program

# Failures that a navigator caused by an exception or an invalid command, and so repeats:
_REPEATED = ("act ", "reset ", "in rehearsal ", "the scenario's background ")

Installed = Mapping[str, tuple[Entry | None, str]]  # by label: `installed`


def rerun(
    run: RunFolder, cells: Sequence[Cell], checks: Sequence[PartCheck], folder: Path,
    report: Report, *, workers: int, progress: Progress | None = None,
) -> None:  # fmt: skip
    """Run the installed navigators again, and report every difference from the run.

    Args:
        run: the run.
        cells: all its cells, of which the navigators also report whether they are n/a.
        checks: the parts to run again.
        folder: an empty folder for the new episodes.
        report: receives the findings, counts and notes.
        workers: processes; 0: this process.
        progress: is notified of every episode.
    """
    entries = all_installed(run, cells)
    check_reasons(run, cells, entries, report)
    parts = Rerun(folder, Limits.of(run.manifest.limits), report, progress or Progress())
    for check in checks:
        parts.add(check, entries[check.cell.entry.label])
    parts.run(workers)


@dataclass(frozen=True)
class Rerun:
    """Parts to run again.

    ``folder`` is for the new episodes; ``limits`` are those of the run.
    """

    folder: Path
    limits: Limits
    report: Report
    progress: Progress
    tasks: list[Task] = field(default_factory=list)
    stored: dict[tuple[str, int], PartCheck] = field(default_factory=dict)  # by cell and seed

    def add(self, check: PartCheck, entry: tuple[Entry | None, str]) -> None:
        """Plan the episodes of a part that can be run again."""
        found, why = entry
        seeds = list(check.part.seeds)
        if found is None:
            self._leave_out(seeds, why)
            return
        try:
            rows = check.part.results().select(["seed", "failure"]).to_pylist()
            failures = {row["seed"]: row["failure"] for row in rows}
        except CorruptPartError:
            self._leave_out(seeds, "its part cannot be read")
            return
        for seed in seeds:
            failure = failures.get(seed, "")
            if not _may_fail_again(failure):
                self._leave_out([seed], f"it failed because {failure}")
        again = [seed for seed in seeds if _may_fail_again(failures.get(seed, ""))]
        folder = self.folder / check.cell.key
        for first, stop in chunks(again, check.cell.effort):
            self.tasks.append(Task(check.cell, folder, first, stop, salt=check.salt))
        self.stored.update(((check.cell.key, seed), check) for seed in again)

    def run(self, workers: int) -> None:
        """Run, and report every episode that differs in any bit."""
        tasks = sorted(self.tasks, key=lambda task: -task.cell.effort * len(task.seeds))
        self.progress.expect(task.load for task in tasks)
        if not tasks:
            return
        with closing(execute(tasks, workers, self.progress, self.limits)) as finished:
            for task, outcome in finished:
                if outcome.lacks:
                    self._leave_out(task.seeds, outcome.lacks)
                else:
                    self._compare(task)

    def _leave_out(self, seeds: Sequence[int], why: str) -> None:
        self.report.notes[f"episode not run again: {why}"] += len(seeds)
        self.progress.advance(len(seeds))

    def _compare(self, task: Task) -> None:
        check = self.stored[task.cell.key, task.first]
        part = Part(task.folder, task.first, task.stop)
        new = {_place(episode): episode for episode in _episodes(part)}
        for old in _episodes(check.part):
            if _place(old) not in new:
                continue  # of another task; missing rehearsals are found by re-simulation
            again = new[_place(old)]
            if not (old.reproducible or again.reproducible):
                why = "a clock decides what its navigator does"
                self.report.notes[f"episode not run again: {why}"] += not old.identity.rehearsal
                continue
            self.report.counts["rerun"] += not old.identity.rehearsal
            for name in ("digest", "failure", "reproducible", "remarks"):
                left, right = getattr(old, name), getattr(again, name)
                if left != right:
                    text = f"{name} is {_short(left)}, run again {_short(right)}"
                    self.report.find("rerun", check.place(old), text)
        for suffix in (*FILES, SEAL):
            part.path(suffix).unlink(missing_ok=True)


def _episodes(part: Part) -> Iterator[Episode]:
    yield from part.episodes()
    yield from part.rehearsals()


def _place(episode: Episode) -> tuple[int, int]:
    return episode.identity.seed, episode.identity.rehearsal


def _may_fail_again(failure: str) -> bool:
    return not failure or failure.startswith(_REPEATED)


def installed(entry: Entry, packed: bool, cells: Sequence[Cell]) -> tuple[Entry | None, str]:
    """Return (the navigator as installed here, ""), or (None, why it cannot be used).

    No module that an untrusted pack names is imported, and none of its programs is started:
    only registered plugins are used. ``cells`` have the sensors that it must support.
    """
    if packed and is_program(entry.spec):
        return None, f"{entry.label} is a program, in an untrusted pack"
    if packed and is_by_module(entry.spec):
        return None, f"{entry.label} is named by its module, in an untrusted pack"
    sensings = tuple(dict.fromkeys(sensing_of(cell.scenario) for cell in cells))
    meeting = Meeting(sensings, entry.mode == ISOLATED)
    try:
        spec, where = {**entry.spec, "label": entry.label}, f"the navigator {entry.label!r}"
        found = meeting.entry(spec, where)
    except BenchnavError as error:
        return None, f"{entry.label} cannot be created here: {_short(str(error))}"
    if found.lacks:
        return None, f"{entry.label} cannot be created here: {found.lacks}"
    if found.hash != entry.hash:
        return None, f"{entry.label} is another one here ({found.source} instead of {entry.source})"
    if entry.source_hash and found.source_hash != entry.source_hash:
        return None, f"{entry.label} has another source here"
    return found, ""


def all_installed(run: RunFolder, cells: Sequence[Cell]) -> Installed:
    """Return the installed navigators of a run, and why others are missing."""
    packed = run.packed is not None
    entries = {cell.entry.label: cell.entry for cell in cells}
    return {label: installed(entry, packed, cells) for label, entry in entries.items()}


def check_reasons(
    run: RunFolder, cells: Sequence[Cell], entries: Installed, report: Report
) -> None:
    """Report cells whose n/a status does not match the installed navigator."""
    reasons = {str(c["key"]): str(c.get("reason", "")) for c in run.manifest.cells}
    for cell in cells:
        label = cell.entry.label
        entry, why = entries[label]
        stored = reasons.get(cell.key, "")
        if entry is None:
            if stored:
                report.notes[f"reason of a cell that is n/a: {why}"] += 1
            continue
        if entry.uses_map != cell.entry.uses_map:
            where = f"{cell.scenario.identity}, {label}"
            uses = "uses" if entry.uses_map else "does not use"
            report.find("rerun", where, f"the navigator reports that it {uses} the map")
        if entry.training != cell.entry.training:
            where = f"{cell.scenario.identity}, {label}"
            text = f"training is {cell.entry.training}, but the navigator reports {entry.training}"
            report.find("rerun", where, text)
        right = dataclasses.replace(cell, entry=entry).reason
        report.counts["rerun n/a"] += bool(stored)
        if right != stored:
            where = f"{cell.scenario.identity}, {cell.track}, {label}"
            report.find("rerun", where, f"n/a: {stored!r}, but the navigator reports {right!r}")


def _short(value: Any) -> str:
    text = value if isinstance(value, str) else repr(value)
    return shortened(re.sub(r"\s+", " ", text), 120)
