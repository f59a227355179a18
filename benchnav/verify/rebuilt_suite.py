"""The suite that a manifest tells of, made anew without any of its navigators."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from benchnav.errors import BenchnavError
from benchnav.navigation.navigator import Training
from benchnav.runner.plan.contestant import Entry
from benchnav.runner.plan.job import Cell
from benchnav.runner.plan.limits import Limits
from benchnav.runner.plan.shard import Shard
from benchnav.runner.plan.suite import Block, Suite
from benchnav.runner.plan.suite_file import MAX_SEEDS
from benchnav.scenario.parameters import split_parameters
from benchnav.scenario.scenario import Scenario
from benchnav.store.runs.manifest import IN_PROCESS, ISOLATED
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.scenario_files import stage_files
from benchnav.verify.finding import Report

_MALFORMED = (KeyError, TypeError, ValueError, AttributeError, IndexError, RecursionError)
_SPLITS = ("train", "validation", "test")


@dataclass(frozen=True)
class Restored:
    """What a run is a run of."""

    seeds: range
    cells: tuple[Cell, ...]  # every cell, n/a ones included, in the order of the manifest


def restore(run: RunFolder, root: Path, report: Report) -> Restored | None:
    """The suite of ``run``; None where it cannot be made, which the report then says.

    Args:
        run: whose manifest tells.
        root: an empty folder for the files that scenarios name.
        report: gets every disagreement within the manifest.
    """
    suite = run.manifest.suite
    where = str(run.shown / "manifest.json")
    try:
        first, stop = suite["seeds"]
        split, tracks = suite["split"], tuple(map(str, suite["tracks"]))
        blocks = tuple(Block(**_tuples(said)) for said in suite.get("blocks", ()))
        whole = all(type(seed) is int and seed >= 0 for seed in (first, stop))
        if not whole or not 1 <= stop - first <= MAX_SEEDS or split not in _SPLITS:
            raise ValueError(f"seeds {suite['seeds']!r} of split {split!r}")
        sources = run.manifest.sources
        entries = [_entry(said, sources.get(said["label"], {})) for said in suite["navigators"]]
        known = len(report.findings)
        drawn = [
            _scenario(run, root / str(i), said, report) for i, said in enumerate(suite["scenarios"])
        ]
        scenarios = [scenario for scenario in drawn if scenario is not None]
        if len(report.findings) > known:
            return None
        whole_suite = Suite(
            str(suite["name"]), suite["version"], split, range(first, stop), tuple(scenarios),
            tracks, tuple(entries), blocks=blocks,
        )  # fmt: skip
        cells = list(whole_suite.cells())
    except _MALFORMED as error:
        report.find("manifest", where, f"the suite cannot be read: {type(error).__name__}: {error}")
        return None
    _compare_cells(run, cells, where, report)
    _check_claims(run, where, report)
    return Restored(whole_suite.seeds, tuple(cells))


def _check_claims(run: RunFolder, where: str, report: Report) -> None:
    """What nobody can recompute must at least be possible."""
    try:
        Limits.of(run.manifest.limits)
        if run.manifest.shard:
            Shard.parse(run.manifest.shard)
    except (TypeError, ValueError) as error:
        report.find("manifest", where, f"a limit or the shard is none: {error}")
    if run.manifest.shard and any("seeds" not in c and not c["reason"] for c in run.manifest.cells):
        report.find("manifest", where, "every cell of a shard must say which seeds are its share")
    labels = {str(entry["label"]) for entry in run.manifest.suite["navigators"]}
    for label in sorted(set(run.manifest.unguarded) - labels):
        report.find("manifest", where, f"unguarded names {label!r}, which is no navigator of it")


def _scenario(
    run: RunFolder, root: Path, said: Mapping[str, Any], report: Report
) -> Scenario | None:
    identity = str(said["scenario"])
    try:
        _, chosen = split_parameters(identity)
        scenario = Scenario.model_validate(said["says"])
        scenario = scenario.placed_in(stage_files(run.path, said["files"], root), chosen)
        named = {n for n in scenario.named_files() if n not in said["files"]}
        if named:
            report.find("scenario", identity, f"names {min(named)!r}, which the run does not hold")
            return None
        found = scenario.hash
    except (BenchnavError, ValidationError, OSError) as error:
        report.find("scenario", identity, f"cannot be made again: {_short(error)}")
        return None
    if scenario.identity != identity:
        report.find("scenario", identity, f"says of itself that it is {scenario.identity}")
    if found != said["hash"]:
        report.find("scenario", identity, f"has the hash {found}, not {said['hash']}")
    return scenario


def _tuples(said: Mapping[str, Any]) -> dict[str, tuple[str, ...]]:
    return {name: tuple(map(str, listed)) for name, listed in said.items()}


def _entry(said: Mapping[str, Any], source: Mapping[str, Any] = {}) -> Entry:
    led = _entry(said["leader"]) if "leader" in said else None
    training = Training(**said["training"]) if "training" in said else None
    return Entry(
        str(said["label"]), dict(said["says"]), str(said["source"]), frozenset(),
        training=training, fingerprint=str(said.get("fingerprint", "")),
        rehearsal=int(said.get("rehearsal", 0)), leader=led,
        uses_map=bool(said.get("uses_map", True)),
        mode=ISOLATED if said.get("mode") == ISOLATED else IN_PROCESS,
        places=tuple(source.get("places", ())), source_hash=str(source.get("hash", "")),
    )  # fmt: skip


def _compare_cells(run: RunFolder, cells: list[Cell], where: str, report: Report) -> None:
    """The manifest's cells must be the product of its suite, under the keys that follow."""
    stored = run.manifest.cells
    if len(stored) != len(cells):
        report.find("manifest", where, f"there are {len(stored)} cells, not {len(cells)}")
    for i, (said, cell) in enumerate(zip(stored, cells, strict=False)):
        expected: dict[str, Any] = {
            "key": cell.key, "scenario": cell.scenario.identity, "track": cell.track,
            "navigator": cell.entry.label,
        }  # fmt: skip
        if cell.also or "also" in said:
            expected["also"] = list(cell.also)
        if not run.manifest.shard and "seeds" in said:
            expected["seeds"] = None  # only a shard says which seeds it runs
        for name, value in expected.items():
            if said.get(name) != value:
                report.find(
                    "manifest", where, f"cells[{i}].{name} is {said.get(name)!r}, not {value!r}"
                )
        absent = f"the scenario has no track {cell.track!r}"
        granted = cell.track in cell.scenario.granted_tracks
        if granted == (said.get("reason") == absent):
            has = "a" if granted else "no"
            report.find(
                "manifest", where,
                f"cells[{i}].reason is {said.get('reason')!r}; there is {has} track {cell.track!r}",
            )  # fmt: skip


def _short(error: Exception) -> str:
    return re.sub(r"\s+", " ", str(error))[:300]
