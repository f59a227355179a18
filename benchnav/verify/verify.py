"""Verify a whole run, part by part, in worker processes."""

from collections.abc import Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass
from pathlib import Path

from benchnav.errors import StoreError
from benchnav.metrics.declared import declared_metrics
from benchnav.plugins import registrations
from benchnav.processes.main_module import main_of
from benchnav.processes.worker_pool import submitted, worker_pool
from benchnav.runner.execute.progress import Progress
from benchnav.runner.plan.installed_differences import caveats_of
from benchnav.runner.plan.limits import Limits
from benchnav.runner.plan.task import Measuring
from benchnav.store.runs.manifest import Manifest, versions
from benchnav.store.runs.pinned_run import changed_since, pinned, pinned_digest
from benchnav.store.runs.provenance import sentence
from benchnav.store.runs.run_folder import RunFolder
from benchnav.system.temporary_folder import TemporaryFolder
from benchnav.threads import core_count
from benchnav.verify.completeness import covered
from benchnav.verify.examination import Examination, examine
from benchnav.verify.finding import Report
from benchnav.verify.installed_source import compare_source
from benchnav.verify.part_check import PartCheck
from benchnav.verify.rebuilt_suite import RebuiltSuite, restore
from benchnav.verify.reference.fcl_check import require_referee
from benchnav.verify.reference.sample import sampled
from benchnav.verify.rerun import rerun

VERIFIABLE = 3  # first schema in which a run holds everything that verifying needs


@dataclass(frozen=True)
class Wanted:
    """The checks beyond re-simulation."""

    twin: int = 20  # number of episodes that the reference simulator replays
    twin_seconds: float = 20.0  # [s] of processor time for these replays, shared equally
    referee: bool = False  # judge every contact again with trimesh and python-fcl
    rerun: bool = False  # run the navigators again


def verify(
    run: RunFolder,
    wanted: Wanted = Wanted(),
    *,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Report:
    """Re-simulate a run and check everything in it.

    Args:
        run: the run; it is only read, in its state at the beginning.
        wanted: the checks beyond re-simulation.
        workers: processes; None: as many as there are cores; 0: in this process.
        progress: is notified of every finished episode.

    Raises:
        StoreError: an older benchnav produced the run, which did not store what this needs.
        MissingExtraError: the referee is requested, and python-fcl or trimesh is not installed.
    """
    if wanted.referee:
        require_referee()
    reporter = progress if progress is not None else Progress()
    run = pinned(run)
    report = Report(content=pinned_digest(run))
    with TemporaryFolder("verify") as root:
        count = core_count() if workers is None else workers
        suite = rebuilt(run, root.path, report)
        tasks = tasks_of(run, suite, wanted, report, guarded=count > 0) if suite else []
        episodes = sum(len(task.check.part.seeds) for task in tasks)
        reporter.begin(episodes * (2 if wanted.rerun else 1), 0)
        try:
            fit = _examined(tasks, count, report, reporter)
            if wanted.rerun and suite:
                folder = root.path / "rerun"
                rerun(run, suite.jobs, fit, folder, report, workers=count, progress=reporter)
        finally:
            reporter.end()
    changed = changed_since(run)
    if changed:
        more = f" and {len(changed) - 1} more" if len(changed) > 1 else ""
        report.find(
            "changed", str(run.shown),
            f"{changed[0]}{more} changed while the run was verified: verify again when no process"
            " writes it",
        )  # fmt: skip
    report.sort()
    return report


def _examined(
    tasks: Sequence[Examination], workers: int, report: Report, reporter: Progress
) -> list[PartCheck]:
    """Return the parts whose worlds could be drawn and read; add all findings to the report."""
    fit = []
    for task, part in _done(tasks, workers):
        report.add(part)
        reporter.advance(len(task.check.part.seeds))
        if all(finding.kind not in ("seal", "world") for finding in part.findings):
            fit.append(task.check)
    return fit


def rebuilt(run: RunFolder, root: Path, report: Report) -> RebuiltSuite | None:
    """Return the suite of a pinned run, built again in ``root``; None after fatal findings.

    Raises StoreError if the run stores too little to be verified.
    """
    if run.manifest.schema < VERIFIABLE:
        raise StoreError(
            f"A run must be of schema {VERIFIABLE} or later to be verified. {run.shown} is of"
            f" schema {run.manifest.schema}, which stores too little. Run the suite again."
        )
    _note_versions(run, report)
    return restore(run, root, report)


def tasks_of(
    run: RunFolder, suite: RebuiltSuite, wanted: Wanted, report: Report, *, guarded: bool = True
) -> list[Examination]:
    """Return the examinations of a pinned run; report the findings in its manifest.

    ``guarded``: metrics of plugins are measured in separate processes.
    """
    report.caveats += [caveat.text for caveat in caveats_of(run.manifest)]
    report.claims = _claims(run.manifest) if report.clean else ""
    evaluated = [job for job in suite.jobs if not job.undisturbed]
    contestants = {job.contestant.label: job.contestant for job in evaluated}
    report.sources += [compare_source(e, run.packed is not None) for e in contestants.values()]
    version = str(run.manifest.versions.get("benchnav", ""))
    metrics = {name: metric.verifiable for name, metric in declared_metrics()[0].items()}
    measuring = _measuring(run) if guarded else None
    checks = [
        PartCheck(job, part, run.manifest.salt, suite.seeds.start, version, metrics, measuring)
        for job, part in covered(run, suite, report)
    ]
    checks.sort(key=lambda c: (c.job.scenario.identity, c.part.first))  # they share worlds
    chosen = sampled(checks, wanted.twin)
    share = wanted.twin_seconds / max(sum(map(len, chosen)), 1)
    return [
        Examination(check, tuple(seeds), share, wanted.referee)
        for check, seeds in zip(checks, chosen, strict=True)
    ]


def _measuring(run: RunFolder) -> Measuring:
    timeout = Limits.of(run.manifest.limits).timeout
    known = tuple(registrations())
    return Measuring((), known, main_of(value for _, _, value in known), timeout)


def _claims(manifest: Manifest) -> str:
    """Return the statements of the manifest that nothing else in the run supports."""
    suite = manifest.suite
    shard = f", shard {manifest.shard}" if manifest.shard else ""
    return (
        f"suite {suite['name']} at version {suite['version']}{shard}, limits"
        f" {Limits.of(manifest.limits)}, titles and descriptions of scenarios, made on"
        f" {manifest.created} by benchnav {manifest.versions.get('benchnav')} on"
        f" {manifest.platform}{sentence(manifest.provenance)}"
    )


def _note_versions(run: RunFolder, report: Report) -> None:
    here = versions()
    for name, version in run.manifest.versions.items():
        if name in here and here[name] != version:
            report.versions.append(f"{name} {version} produced the run; {here[name]} is here")


def _done(tasks: Sequence[Examination], workers: int) -> Iterator[tuple[Examination, Report]]:
    if workers == 0:
        for task in tasks:
            yield task, examine(task)
        return
    with worker_pool(min(workers, max(len(tasks), 1)), "Try 1 worker.") as pool:
        running = dict(zip(submitted(pool, examine, tasks), tasks, strict=True))
        for future in as_completed(running):
            yield running[future], future.result()
