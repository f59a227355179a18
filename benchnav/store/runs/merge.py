"""Merge runs of shares of one suite into one run, equal to a run of the whole suite."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc

from benchnav.episode.episode import Episode
from benchnav.errors import RunConflictError, StoreError, UsageError
from benchnav.store.parts.part import FILES, SEAL, Part, parts_of
from benchnav.store.parts.part_writer import PartWriter, receive
from benchnav.store.runs.manifest import Manifest
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.run_path import RunPath, run_path
from benchnav.store.runs.scenario_files import FOLDER, keep_files
from benchnav.store.runs.spans import spans
from benchnav.text.visible import shortened

_SHARED = ("suite_hash", "salt", "limits", "versions", "schema")


@dataclass
class Merged:
    """The result of merging."""

    run: RunFolder
    copied: int = 0  # episodes
    twice: int = 0  # episodes that were there already, and are equal
    _digests: dict[str, dict[int, str]] = field(default_factory=dict)  # by cell and seed


def merge(given: Sequence[RunPath], into: RunPath) -> Merged:
    """Copy every part of some runs into another run; parts that are there already must be equal.

    Args:
        given: runs of one suite, with one salt, one set of limits and the same versions.
        into: a new folder, or a run of the same suite.

    Raises:
        UsageError: there is nothing to merge, or ``into`` is one of ``given``.
        RunConflictError: the runs do not belong together, or differ where they overlap.
        StoreError: the disk refuses, a folder is not a run, or a part is damaged.
    """
    runs, out = [run_path(run) for run in given], run_path(into)
    if not runs or any(out.resolve() == run.resolve() for run in runs):
        raise UsageError(f"Runs must be merged into another folder. Got {out} for both.")
    folders = [RunFolder.open(run) for run in runs]
    for other in folders[1:]:
        _refuse_different(folders[0], other)
    target = RunFolder.start(out, _joined([folder.manifest for folder in folders]))
    _refuse_different(folders[0], target)
    if target.manifest.shard:
        raise RunConflictError(
            f"{out} must be new or hold a merged run. It holds shard {target.manifest.shard}."
        )
    merged = Merged(target)
    with target.writing():
        for folder in folders:
            _copy_files(folder.path, out)
            for cell in folder.manifest.cells:
                for part in folder.parts_in(cell):
                    part.check_rows()
                    _copy(part, cell["key"], merged)
    return merged


def _refuse_different(one: RunFolder, other: RunFolder) -> None:
    for name in _SHARED:
        here, there = getattr(one.manifest, name), getattr(other.manifest, name)
        if here != there:
            raise RunConflictError(
                f"Runs to merge must share their {name.replace('_', ' ')}."
                f" {one.path} has {_short(here)}, {other.path} has {_short(there)}."
            )
    _refuse_other_source(one, other)


def _refuse_other_source(one: RunFolder, other: RunFolder) -> None:
    """Raise RunConflictError if two runs used different code of a navigator."""
    for label in one.manifest.sources.keys() & other.manifest.sources.keys():
        here, there = one.manifest.source_of(label), other.manifest.source_of(label)
        if here != there:
            raise RunConflictError(
                f"Runs to merge must share the source of {label!r}. {one.path} has {here},"
                f" {other.path} has {there}. Repeat one of them with the code of the other"
                " (option 'again')."
            )


def _short(value: object) -> str:
    return shortened(str(value), 200)


def _joined(manifests: Sequence[Manifest]) -> Manifest:
    """Return the manifest of the whole suite; a cell that one run executed execute is not n/a."""
    executed = {cell["key"] for m in manifests for cell in m.cells if not cell["reason"]}
    cells = []
    for cell in manifests[0].cells:
        entry: Mapping[str, Any] = {k: v for k, v in cell.items() if k != "seeds"}
        cells.append({**entry, "reason": ""} if cell["key"] in executed else entry)
    sources = {label: source for m in manifests for label, source in m.sources.items()}
    unguarded = dict.fromkeys(label for m in manifests for label in m.unguarded)
    return replace(
        manifests[0], cells=tuple(cells), shard="", sources=sources, unguarded=tuple(unguarded)
    )


def _copy_files(run: Path, out: Path) -> None:
    folder = run / FOLDER
    if folder.is_dir():
        keep_files(out, {path.name: path for path in folder.iterdir() if len(path.name) == 64})


def _copy(part: Part, key: str, merged: Merged) -> None:
    """Copy the files if no seed is there yet; otherwise only the new seeds of the part."""
    target = Part(merged.run.cell(key), part.first, part.stop)
    held = merged.run.done(key)
    new = set(part.seeds) - held
    merged.copied += len(new)
    merged.twice += len(part.seeds) - len(new)
    if len(new) == len(part.seeds):
        paths = {suffix: part.path(suffix) for suffix in (*FILES, SEAL)}
        part.check()
        receive(target, {s: _read(path) for s, path in paths.items() if path.exists()})
        return
    _refuse_disagreement(part, key, held, merged)
    for first, stop in spans(new):
        _rewrite(part, Part(target.folder, first, stop))


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise StoreError(f"{path} is not readable: {error.strerror}.") from error


def _refuse_disagreement(part: Part, key: str, held: set[int], merged: Merged) -> None:
    known = merged._digests.get(key)
    if known is None or not held <= set(known):
        stored = [p for p in parts_of(merged.run.cell(key)) if held & set(p.seeds)]
        known = {e.identity.seed: e.digest for p in stored for e in p.episodes()}
        merged._digests[key] = known
    for episode in part.episodes():
        seed = episode.identity.seed
        if seed in held and known[seed] != episode.digest:
            raise RunConflictError(
                f"Where runs overlap they must agree. {part.path(FILES[0])} and"
                f" {merged.run.cell(key)} differ at seed {seed}."
            )


def _rewrite(part: Part, target: Part) -> None:
    """Write the seeds of ``target`` from a part that holds more."""
    seeds = set(target.seeds)
    results = part.results()
    chosen = results.filter(pc.is_in(results["seed"], pa.array(sorted(seeds), pa.int64())))
    with PartWriter(target) as writer:
        writer.add(list(_of(part.episodes(), seeds)), chosen, list(_of(part.rehearsals(), seeds)))
        writer.seal()


def _of(episodes: Iterator[Episode], seeds: set[int]) -> Iterator[Episode]:
    return (episode for episode in episodes if episode.identity.seed in seeds)
