"""Rebuild the suite of a manifest without any of its navigators."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from benchnav.errors import BenchnavError
from benchnav.navigation.navigator import Training
from benchnav.runner.plan.contestant import Contestant
from benchnav.runner.plan.job import Job
from benchnav.runner.plan.limits import Limits
from benchnav.runner.plan.shard import Shard
from benchnav.runner.plan.suite import Block, Suite
from benchnav.runner.plan.suite_file import MAX_SEEDS
from benchnav.scenario.condition import EXACT, perceptions_of
from benchnav.scenario.parameters import split_parameters
from benchnav.scenario.scenario import Scenario
from benchnav.store.runs.manifest import IN_PROCESS, ISOLATED
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.scenario_files import stage_files
from benchnav.text.visible import shortened
from benchnav.verify.finding import Report

_MALFORMED = (KeyError, TypeError, ValueError, AttributeError, IndexError, RecursionError)
_SPLITS = ("train", "validation", "test")


@dataclass(frozen=True)
class RebuiltSuite:
    """The rebuilt suite of a run."""

    seeds: range
    jobs: tuple[Job, ...]  # every cell, n/a ones included, in the order of the manifest


def restore(run: RunFolder, root: Path, report: Report) -> RebuiltSuite | None:
    """Return the suite of ``run``; None if it cannot be rebuilt, with a finding in the report.

    Args:
        run: the run with the manifest.
        root: an empty folder for the files that scenarios name.
        report: gets every disagreement within the manifest.
    """
    suite = run.manifest.suite
    where = str(run.shown / "manifest.json")
    try:
        first, stop = suite["seeds"]
        split, tracks = suite["split"], tuple(map(str, suite["tracks"]))
        blocks = tuple(map(_block, suite.get("blocks", ())))
        whole = all(type(seed) is int and seed >= 0 for seed in (first, stop))
        if not whole or not 1 <= stop - first <= MAX_SEEDS or split not in _SPLITS:
            raise ValueError(f"seeds {suite['seeds']!r} of split {split!r}")
        sources = run.manifest.sources
        contestants = [
            _contestant(fields, sources.get(fields["label"], {})) for fields in suite["navigators"]
        ]
        known = len(report.findings)
        drawn = [
            _scenario(run, root / str(i), fields, report)
            for i, fields in enumerate(suite["scenarios"])
        ]
        scenarios = [scenario for scenario in drawn if scenario is not None]
        if len(report.findings) > known:
            return None
        whole_suite = Suite(
            str(suite["name"]), suite["version"], split, range(first, stop), tuple(scenarios),
            tracks, tuple(contestants), blocks=blocks, perceptions=perceptions_of(suite),
            undisturbed=bool(suite.get("undisturbed")),
        )  # fmt: skip
        jobs = list(whole_suite.jobs())
    except _MALFORMED as error:
        report.find("manifest", where, f"the suite cannot be read: {type(error).__name__}: {error}")
        return None
    if "undisturbed" in suite and not any(job.undisturbed for job in jobs):
        report.find(
            "manifest", where, "undisturbed must be left out: the suite has no undisturbed worlds"
        )
    _compare_cells(run, jobs, where, report)
    _check_claims(run, where, report)
    return RebuiltSuite(whole_suite.seeds, tuple(jobs))


def _check_claims(run: RunFolder, where: str, report: Report) -> None:
    """Report impossible statements among those that cannot be recomputed."""
    try:
        Limits.of(run.manifest.limits)
        if run.manifest.shard:
            Shard.parse(run.manifest.shard)
    except (TypeError, ValueError) as error:
        report.find("manifest", where, f"a limit or the shard is invalid: {error}")
    if run.manifest.shard and any("seeds" not in c and not c["reason"] for c in run.manifest.cells):
        report.find("manifest", where, "every cell of a shard must list the seeds of its share")
    labels = {str(fields["label"]) for fields in run.manifest.suite["navigators"]}
    for label in sorted(set(run.manifest.unguarded) - labels):
        report.find("manifest", where, f"unguarded names {label!r}, which is not a navigator of it")


def _scenario(
    run: RunFolder, root: Path, fields: Mapping[str, Any], report: Report
) -> Scenario | None:
    identity = str(fields["scenario"])
    try:
        _, chosen = split_parameters(identity)
        scenario = Scenario.model_validate(fields["config"])
        scenario = scenario.placed_in(stage_files(run.path, fields["files"], root), chosen)
        named = {n for n in scenario.named_files() if n not in fields["files"]}
        if named:
            report.find("scenario", identity, f"names {min(named)!r}, which the run does not hold")
            return None
        found = scenario.hash
    except (BenchnavError, ValidationError, OSError) as error:
        report.find("scenario", identity, f"cannot be rebuilt: {_short(error)}")
        return None
    if scenario.identity != identity:
        report.find("scenario", identity, f"describes itself as {scenario.identity}")
    if found != fields["hash"]:
        report.find("scenario", identity, f"has the hash {found}, not {fields['hash']}")
    return scenario


def _block(fields: Mapping[str, Any]) -> Block:
    scenarios, tracks, navigators = (
        tuple(map(str, fields[key])) for key in ("scenarios", "tracks", "navigators")
    )
    return Block(scenarios, tracks, navigators, perceptions_of(fields))


def _contestant(fields: Mapping[str, Any], source: Mapping[str, Any] = {}) -> Contestant:
    leader = _contestant(fields["leader"]) if "leader" in fields else None
    training = Training(**fields["training"]) if "training" in fields else None
    return Contestant(
        str(fields["label"]), dict(fields["config"]), str(fields["source"]), frozenset(),
        training=training, fingerprint=str(fields.get("fingerprint", "")),
        rehearsal=int(fields.get("rehearsal", 0)), leader=leader,
        uses_map=bool(fields.get("uses_map", True)),
        mode=ISOLATED if fields.get("mode") == ISOLATED else IN_PROCESS,
        places=tuple(source.get("places", ())), source_hash=str(source.get("hash", "")),
    )  # fmt: skip


def _compare_cells(run: RunFolder, jobs: list[Job], where: str, report: Report) -> None:
    """Report cells that differ from the product of the suite, or have other keys."""
    stored = run.manifest.cells
    if len(stored) != len(jobs):
        report.find("manifest", where, f"there are {len(stored)} cells, not {len(jobs)}")
    for i, (fields, job) in enumerate(zip(stored, jobs, strict=False)):
        expected: dict[str, Any] = {
            "key": job.key, "scenario": job.scenario.identity, "track": job.track,
            "navigator": job.contestant.label,
        }  # fmt: skip
        if job.perception != EXACT or "perception" in fields:
            expected["perception"] = job.perception
        if job.also or "also" in fields:
            expected["also"] = list(job.also)
        if not run.manifest.shard and "seeds" in fields:
            expected["seeds"] = None  # only a shard lists its seeds
        for name, value in expected.items():
            if fields.get(name) != value:
                report.find(
                    "manifest", where, f"cells[{i}].{name} is {fields.get(name)!r}, not {value!r}"
                )
        absent = f"the scenario has no track {job.track!r}"
        granted = job.undisturbed or job.track in job.scenario.granted_tracks
        if granted == (fields.get("reason") == absent):
            has = "a" if granted else "no"
            report.find(
                "manifest", where,
                f"cells[{i}].reason is {fields.get('reason')!r};"
                f" there is {has} track {job.track!r}",
            )  # fmt: skip


def _short(error: Exception) -> str:
    return shortened(re.sub(r"\s+", " ", str(error)), 300)
