"""The parts that a run must have, and those that it has."""

from collections.abc import Iterator
from itertools import islice

from benchnav.errors import CorruptPartError
from benchnav.runner.plan.job import Job
from benchnav.store.parts.part import Part, parts_of
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.spans import count, twice, union, without
from benchnav.text.plural import counted
from benchnav.verify.finding import Report
from benchnav.verify.rebuilt_suite import RebuiltSuite

_SHOWN = 10  # seeds of each kind


def covered(run: RunFolder, suite: RebuiltSuite, report: Report) -> Iterator[tuple[Job, Part]]:
    """Yield every part with its cell; report missing and surplus seeds and parts."""
    stored = {str(c["key"]): c for c in run.manifest.cells}
    for job in suite.jobs:
        where = job.shown
        fields = stored.get(job.key, {"key": job.key})
        reason = str(fields.get("reason", ""))
        if reason:
            if parts_of(run.cell(job.key)):
                report.find("coverage", where, f"is n/a ({reason}), and has episodes")
            report.counts["n/a cells"] += 1
            continue
        try:
            parts = run.parts_in(fields)
        except CorruptPartError as error:
            report.find("manifest", where, str(error))
            continue
        _check_seeds(parts, suite.seeds, where, report)
        for part in parts:
            yield job, part
    known = {run.cell(job.key) for job in suite.jobs}
    for path in sorted((run.path / "parts").glob("*")):
        if path not in known and run.key_of(path):
            report.notes["cell of other source, which an unfinished repetition left"] += 1
        elif path not in known:
            report.find(
                "coverage", str(run.shown / "parts" / path.name), "is not a cell of the suite"
            )


def _check_seeds(parts: list[Part], seeds: range, where: str, report: Report) -> None:
    held = [(part.first, part.stop) for part in parts]
    whole = [(seeds.start, seeds.stop)]
    for text, found in (
        ("missing", without(whole, held)), ("stored twice", twice(held)),
        ("not of the suite", without(union(held), whole)),
    ):  # fmt: skip
        if found:
            some = islice((seed for span in found for seed in range(*span)), _SHOWN)
            few = ", ".join(map(str, some)) + (", …" if count(found) > _SHOWN else "")
            report.find("coverage", where, f"{counted(count(found), 'seed')} {text}: {few}")
