"""The folder of a run: append-only, resumable, one writer at a time."""

import json
import os
import re
import shutil
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from benchnav.errors import CorruptPartError, RunConflictError, StoreError
from benchnav.store.parts.membership import membership
from benchnav.store.parts.part import FILES, SEAL, Part, named_parts, parts_of
from benchnav.store.parts.part_writer import TEMPORARY
from benchnav.store.parts.undisturbed import UndisturbedEpisodes
from benchnav.store.runs.lock import LOCKS, locked
from benchnav.store.runs.manifest import MANIFEST, Manifest, load_manifest
from benchnav.store.runs.run_path import RunPath, run_path
from benchnav.store.runs.spans import Span, without

_SHORT = 10  # digits of a source hash in the name of a folder
_SUFFIX = re.compile(rf"\.[0-9a-f]{{{_SHORT}}}$")


@dataclass(frozen=True)
class RunFolder:
    """A run on disk: ``manifest.json`` and ``parts/<cell>.<source>/<seeds>.*``."""

    path: Path
    manifest: Manifest
    packed: Path | None = None  # the pack from which it was unpacked
    sums: Mapping[str, str] | None = None  # of a pinned run: sha256 of every member, by name

    @property
    def shown(self) -> Path:
        """The path to show in messages."""
        return self.packed or self.path

    @classmethod
    def open(cls, path: RunPath) -> "RunFolder":
        """Return an existing run, for reading.

        Raises UsageError if this is not a path, StoreError if there is no run.
        """
        return cls(run_path(path), load_manifest(path))

    @classmethod
    def start(cls, path: RunPath, manifest: Manifest) -> "RunFolder":
        """Return a new run in an empty or missing folder, or resume the same suite's run.

        An existing run may have other seeds: `extend` adds new ones.

        Raises:
            RunConflictError: the folder holds another suite's run, or other files, or another
                process begins a run there.
            StoreError: the folder cannot be created.
        """
        path = run_path(path)
        if not (path / MANIFEST).exists():
            _refuse_other_content(path, manifest)  # before a lock is created there
            _make(path)
            with locked(path):
                if not (path / MANIFEST).exists():  # another process may begin at the same time
                    _refuse_other_content(path, manifest)
                    _write(path / MANIFEST, manifest.dump())
                    return cls(path, manifest)
        held = load_manifest(path)
        differing = _differing(held, manifest)
        if differing not in ([], ["seeds"]) or (differing and (held.shard or manifest.shard)):
            raise RunConflictError(
                f"{path} must be empty or hold a run of {manifest.name}."
                f" It holds a run of {held.name}, begun {held.created}."
                f" They differ in {', '.join(differing)}. Choose another folder."
            )
        return cls(path, held)

    def extend(self, seeds: range) -> "RunFolder":
        """Add ``seeds`` to those of the run; only the process that holds the folder may call it.

        Raises:
            RunConflictError: there would be a gap between them and the seeds of the run.
            StoreError: the disk refuses.
        """
        manifest = load_manifest(self.path)  # reread: no other process writes it now
        first, stop = manifest.suite["seeds"]
        if seeds.start > stop or seeds.stop < first:
            raise RunConflictError(
                f"The seeds {seeds.start}:{seeds.stop} must touch those of the run in {self.path},"
                f" {first}:{stop}. Use the seeds {min(first, seeds.start)}:"
                f"{max(stop, seeds.stop)}, or choose another folder."
            )
        both = [min(first, seeds.start), max(stop, seeds.stop)]
        if both != [first, stop]:
            manifest = replace(manifest, suite={**manifest.suite, "seeds": both})
            _write(self.path / MANIFEST, manifest.dump())
        return RunFolder(self.path, manifest)

    def amend(self, reasons: Mapping[str, str]) -> "RunFolder":
        """Set the reasons of n/a cells, by key; only for the process that holds the folder.

        Raises StoreError if the disk refuses.
        """
        cells = tuple({**c, "reason": reasons.get(c["key"], "")} for c in self.manifest.cells)
        if cells == self.manifest.cells:
            return self
        return RunFolder(self.path, replace(self.manifest, cells=cells)).kept()

    def unguard(self, labels: Iterable[str]) -> "RunFolder":
        """Record that episodes of ``labels`` run unguarded; only for the folder's writer.

        Raises StoreError if the disk refuses.
        """
        both = tuple(dict.fromkeys((*self.manifest.unguarded, *labels)))
        if both == self.manifest.unguarded:
            return self
        return RunFolder(self.path, replace(self.manifest, unguarded=both)).kept()

    def kept(self) -> "RunFolder":
        """Write the manifest. Raises StoreError if the disk refuses."""
        _write(self.path / MANIFEST, self.manifest.dump())
        return self

    def cell(self, key: str) -> Path:
        """Return the folder of one cell's parts, for the source that the manifest names."""
        source = self.manifest.source_of(self._labels.get(key, ""))
        return self.path / "parts" / (f"{key}.{source[:_SHORT]}" if source else key)

    @cached_property
    def _labels(self) -> dict[str, str]:
        return {cell["key"]: cell.get("navigator", "") for cell in self.manifest.cells}

    def label_of(self, key: str) -> str:
        """Return the navigator of a cell."""
        return self._labels[key]

    def key_of(self, folder: Path) -> str:
        """Return the key of the cell whose parts, of any source, are in ``folder``; "" for none."""
        name = folder.name
        key = name if name in self._labels else _SUFFIX.sub("", name)
        return key if key in self._labels else ""

    def drop_others(self, *kept: "RunFolder") -> None:
        """Remove cells of sources that neither this run nor ``kept`` names; only for the writer."""
        for folder in self.path.glob("parts/*"):
            key = self.key_of(folder)
            if key and all(run.cell(key) != folder for run in (self, *kept)):
                shutil.rmtree(folder)

    def parts(self) -> Iterator[Part]:
        """Yield every sealed part, in the order of the manifest's cells, then of seeds."""
        for cell in self.manifest.cells:
            if not cell["reason"]:
                yield from self.parts_in(cell)

    def parts_in(self, cell: Mapping[str, Any]) -> list[Part]:
        """Return the parts of one manifest cell, by seed; their rows must belong to that cell.

        For a pinned run, these are the pinned parts. Raises CorruptPartError if the manifest
        does not identify the rows of the cell.
        """
        folder = self.cell(cell["key"])
        parts, seals = parts_of(folder), dict[str, str]()
        if self.sums is not None:
            start = f"parts/{folder.name}/"
            names = [name for name in self.sums if name.startswith(start) and name.endswith(SEAL)]
            seals = {name.removeprefix(start): self.sums[name] for name in names}
            parts = named_parts(folder, seals)
        if not parts:
            return []
        try:
            of = membership(self.manifest, cell, seals)
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise CorruptPartError(
                f"{self.shown / MANIFEST} must identify the rows of a cell. It does not: {error}."
            ) from error
        other = self._undisturbed(cell)
        return [replace(part, membership=of, undisturbed=other) for part in parts]

    def undisturbed_key(self, scenario: str) -> str:
        """Return the key of the cell with a scenario's undisturbed episodes; "" without one."""
        cells = (c for c in self.manifest.cells if c["scenario"] == scenario)
        return next((c["key"] for c in cells if self.manifest.is_undisturbed(c)), "")

    def _undisturbed(self, cell: Mapping[str, Any]) -> UndisturbedEpisodes | None:
        """Return the undisturbed episodes that belong to those of a cell."""
        key = self.undisturbed_key(cell["scenario"])
        own = [c for c in self.manifest.cells if c["key"] == key != cell["key"]]
        return UndisturbedEpisodes([p for c in own for p in self.parts_in(c)]) if own else None

    def done(self, key: str) -> set[int]:
        """Return the stored seeds of a cell. Raises CorruptPartError if a part is damaged."""
        return {seed for span in self.held(key) for seed in range(*span)}

    def held(self, key: str) -> list[Span]:
        """Return the stored spans of seeds of a cell, part by part.

        Raises CorruptPartError if a part is damaged.
        """
        parts = parts_of(self.cell(key))
        for part in parts:
            part.check()
        return [(part.first, part.stop) for part in parts]

    def planned(self) -> Iterator[tuple[str, list[Span]]]:
        """Yield (key, spans of seeds) of the cells that can be run."""
        whole = [self.manifest.suite["seeds"]]
        for cell in self.manifest.cells:
            if not cell["reason"]:
                yield cell["key"], [(first, stop) for first, stop in cell.get("seeds", whole)]

    def missing(self) -> Iterator[tuple[str, list[Span]]]:
        """Yield (key, missing spans of seeds) of the cells that can be run and are incomplete.

        Raises CorruptPartError if a part is damaged.
        """
        for key, seeds in self.planned():
            if missing := without(seeds, self.held(key)):
                yield key, missing

    @contextmanager
    def writing(self) -> Iterator["RunFolder"]:
        """Hold the folder as its only writer, and yield it with the current manifest.

        Leftovers are removed before and after. Raises RunConflictError if another process
        writes it.
        """
        with locked(self.path):
            self._sweep()
            try:
                yield RunFolder(self.path, load_manifest(self.path))
            finally:
                self._sweep()

    def _sweep(self) -> None:
        for folder in self.path.glob("parts/*"):
            sealed = {part.stem for part in parts_of(folder)}
            for path in folder.iterdir():
                unsealed = path.name.endswith(FILES)
                unsealed &= path.name.partition(".")[0] not in sealed
                if unsealed or path.name.startswith(TEMPORARY):
                    path.unlink()


def _refuse_other_content(path: Path, manifest: Manifest) -> None:
    if path.exists() and (not path.is_dir() or not _is_free(path)):
        raise RunConflictError(
            f"{path} must be an empty folder or a run of {manifest.name}."
            " It has other content. Choose another folder."
        )


def _make(path: Path) -> None:
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StoreError(f"{path} is not writable: {error.strerror}.") from error


def _is_free(folder: Path) -> bool:
    names = {path.name for path in folder.iterdir()}
    if MANIFEST in names:  # another process began a run meanwhile
        return True
    return all(name in LOCKS or name.startswith(TEMPORARY) for name in names)


def _write(path: Path, text: str) -> None:
    temporary = path.with_name(TEMPORARY + path.name)
    try:
        with temporary.open("w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    except OSError as error:
        raise StoreError(f"{path} is not writable: {error.strerror}.") from error


def _differing(held: Manifest, new: Manifest) -> list[str]:
    """Return the keys of the suite in which the two differ."""
    left, right = held.plan, new.plan
    keys = dict.fromkeys([*right, *left])
    return [key for key in keys if _json(left.get(key)) != _json(right.get(key))]


def _json(value: object) -> str:
    return json.dumps(value, sort_keys=True)  # equal for a tuple and its stored list
