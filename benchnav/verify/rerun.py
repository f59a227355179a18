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
from benchnav.runner.plan.contestant import NONE, Contestant, ContestantFactory
from benchnav.runner.plan.job import Job
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

Installed = Mapping[str, tuple[Contestant | None, str]]  # by label: `installed`


def rerun(
    run: RunFolder, jobs: Sequence[Job], checks: Sequence[PartCheck], folder: Path,
    report: Report, *, workers: int, progress: Progress | None = None,
) -> None:  # fmt: skip
    """Run the installed navigators again, and report every difference from the run.

    Args:
        run: the run.
        jobs: all its cells, of which the navigators also report whether they are n/a.
        checks: the parts to run again.
        folder: an empty folder for the new episodes.
        report: receives the findings, counts and notes.
        workers: processes; 0: this process.
        progress: is notified of every episode.
    """
    contestants = all_installed(run, jobs)
    check_reasons(run, jobs, contestants, report)
    parts = Rerun(folder, Limits.of(run.manifest.limits), report, progress or Progress())
    for check in checks:
        parts.add(check, contestants[check.job.contestant.label])
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

    def add(self, check: PartCheck, installed: tuple[Contestant | None, str]) -> None:
        """Plan the episodes of a part that can be run again."""
        found, why = installed
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
        folder = self.folder / check.job.key
        for first, stop in chunks(again, check.job.effort):
            self.tasks.append(Task(check.job, folder, first, stop, salt=check.salt))
        self.stored.update(((check.job.key, seed), check) for seed in again)

    def run(self, workers: int) -> None:
        """Run, and report every episode that differs in any bit."""
        tasks = sorted(self.tasks, key=lambda task: -task.job.effort * len(task.seeds))
        self.progress.expect(task.load for task in tasks)
        if not tasks:
            return
        with closing(execute(tasks, workers, self.progress, self.limits)) as finished:
            for task, outcome in finished:
                if outcome.missing_extra:
                    self._leave_out(task.seeds, outcome.missing_extra)
                else:
                    self._compare(task)

    def _leave_out(self, seeds: Sequence[int], why: str) -> None:
        self.report.notes[f"episode not run again: {why}"] += len(seeds)
        self.progress.advance(len(seeds))

    def _compare(self, task: Task) -> None:
        check = self.stored[task.job.key, task.first]
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


def installed(
    contestant: Contestant, packed: bool, jobs: Sequence[Job]
) -> tuple[Contestant | None, str]:
    """Return (the navigator as installed here, ""), or (None, why it cannot be used).

    No module that an untrusted pack names is imported, and none of its programs is started:
    only registered plugins are used. ``jobs`` have the sensors that it must support.
    """
    if contestant == NONE:
        return NONE, ""
    label = contestant.label
    if packed and is_program(contestant.spec):
        return None, f"{label} is a program, in an untrusted pack"
    if packed and is_by_module(contestant.spec):
        return None, f"{label} is named by its module, in an untrusted pack"
    sensings = tuple(dict.fromkeys(sensing_of(job.scenario) for job in jobs))
    factory = ContestantFactory(sensings, contestant.mode == ISOLATED)
    try:
        found = factory.create({**contestant.spec, "label": label}, f"the navigator {label!r}")
    except BenchnavError as error:
        return None, f"{label} cannot be created here: {_short(str(error))}"
    if found.missing_extra:
        return None, f"{label} cannot be created here: {found.missing_extra}"
    if found.hash != contestant.hash:
        return None, f"{label} differs here ({found.source} instead of {contestant.source})"
    if contestant.source_hash and found.source_hash != contestant.source_hash:
        return None, f"{label} has another source here"
    return found, ""


def all_installed(run: RunFolder, jobs: Sequence[Job]) -> Installed:
    """Return the installed navigators of a run, and why others are missing."""
    packed = run.packed is not None
    contestants = {job.contestant.label: job.contestant for job in jobs}
    return {label: installed(contestant, packed, jobs) for label, contestant in contestants.items()}


def check_reasons(
    run: RunFolder, jobs: Sequence[Job], contestants: Installed, report: Report
) -> None:
    """Report cells whose n/a status does not match the installed navigator."""
    reasons = {str(c["key"]): str(c.get("reason", "")) for c in run.manifest.cells}
    for job in jobs:
        label = job.contestant.label
        contestant, why = contestants[label]
        stored = reasons.get(job.key, "")
        if contestant is None:
            if stored:
                report.notes[f"reason of a cell that is n/a: {why}"] += 1
            continue
        if contestant.uses_map != job.contestant.uses_map:
            where = f"{job.scenario.identity}, {label}"
            uses = "uses" if contestant.uses_map else "does not use"
            report.find("rerun", where, f"the navigator reports that it {uses} the map")
        if contestant.training != job.contestant.training:
            where = f"{job.scenario.identity}, {label}"
            claimed, reported = job.contestant.training, contestant.training
            text = f"training is {claimed}, but the navigator reports {reported}"
            report.find("rerun", where, text)
        right = dataclasses.replace(job, contestant=contestant).reason
        report.counts["rerun n/a"] += bool(stored)
        if right != stored:
            text = f"n/a: {stored!r}, but the navigator reports {right!r}"
            report.find("rerun", job.shown, text)


def _short(value: Any) -> str:
    text = value if isinstance(value, str) else repr(value)
    return shortened(re.sub(r"\s+", " ", text), 120)
