"""The folder that executing a suite leaves: append-only, resumable, one writer at a time."""

import os
import re
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from benchnav.errors import RunConflictError, StoreError
from benchnav.store.lock import LOCKS, locked
from benchnav.store.manifest import MANIFEST, Manifest, load_manifest
from benchnav.store.part import FILES, Part, parts_of
from benchnav.store.part_writer import TEMPORARY

_SHORT = 10  # digits of a source hash in the name of a folder
_SUFFIX = re.compile(rf"\.[0-9a-f]{{{_SHORT}}}$")


@dataclass(frozen=True)
class RunFolder:
    """A run on disk: ``manifest.json`` and ``parts/<cell>.<source>/<seeds>.*``."""

    path: Path
    manifest: Manifest
    packed: Path | None = None  # the file that it was unpacked from

    @property
    def shown(self) -> Path:
        """What people know it by."""
        return self.packed or self.path

    @classmethod
    def open(cls, path: Path) -> "RunFolder":
        """An existing run, for reading. Raises StoreError where there is none."""
        return cls(path, load_manifest(path))

    @classmethod
    def start(cls, path: Path, manifest: Manifest) -> "RunFolder":
        """A new run in an empty or missing folder, or the same suite's run, resumed.

        Raises:
            RunConflictError: the folder holds another suite's run, or something else.
            StoreError: the folder cannot be made.
        """
        if (path / MANIFEST).exists():
            held = load_manifest(path)
            if held.plan_hash != manifest.plan_hash:
                raise RunConflictError(
                    f"{path} must be empty or hold a run of {manifest.name}."
                    f" It holds a run of {held.name}, begun {held.created}."
                    f"{_difference(held, manifest)} Give another --out."
                )
            return cls(path, held)
        if path.exists() and (not path.is_dir() or not _is_free(path)):
            raise RunConflictError(
                f"{path} must be an empty folder or a run of {manifest.name}."
                " It holds something that is not a run. Give another --out."
            )
        _write(path / MANIFEST, manifest.dump())
        return cls(path, manifest)

    def amend(self, reasons: Mapping[str, str]) -> "RunFolder":
        """Say anew which cells are n/a: why, by key; a writer may, while it holds the folder.

        Raises StoreError where the disk refuses.
        """
        cells = tuple({**c, "reason": reasons.get(c["key"], "")} for c in self.manifest.cells)
        if cells == self.manifest.cells:
            return self
        return RunFolder(self.path, replace(self.manifest, cells=cells)).kept()

    def kept(self) -> "RunFolder":
        """Write the manifest. Raises StoreError where the disk refuses."""
        _write(self.path / MANIFEST, self.manifest.dump())
        return self

    def cell(self, key: str) -> Path:
        """The folder of one cell's parts, as the code made them that the manifest names."""
        source = self.manifest.source_of(self._labels.get(key, ""))
        return self.path / "parts" / (f"{key}.{source[:_SHORT]}" if source else key)

    @cached_property
    def _labels(self) -> dict[str, str]:
        return {cell["key"]: cell.get("navigator", "") for cell in self.manifest.cells}

    def label_of(self, key: str) -> str:
        """Return the navigator of a cell."""
        return self._labels[key]

    def key_of(self, folder: Path) -> str:
        """The key of the cell whose parts, by whatever code, stand in ``folder``; "" for none."""
        name = folder.name
        key = name if name in self._labels else _SUFFIX.sub("", name)
        return key if key in self._labels else ""

    def drop_others(self, *kept: "RunFolder") -> None:
        """Remove what code made that neither this nor ``kept`` name; a writer may."""
        for folder in self.path.glob("parts/*"):
            key = self.key_of(folder)
            if key and all(run.cell(key) != folder for run in (self, *kept)):
                shutil.rmtree(folder)

    def parts(self) -> Iterator[Part]:
        """Every sealed part, in the order of the manifest's cells, then of seeds."""
        for cell in self.manifest.cells:
            if not cell["reason"]:
                yield from parts_of(self.cell(cell["key"]))

    def done(self, key: str) -> set[int]:
        """The seeds of a cell that are stored. Raises CorruptPartError where a part is damaged."""
        seeds: set[int] = set()
        for part in parts_of(self.cell(key)):
            part.check()
            seeds.update(part.seeds)
        return seeds

    def wanted(self) -> Iterator[tuple[str, set[int]]]:
        """(key, seeds) of the cells that can be run."""
        for cell in self.manifest.cells:
            if not cell["reason"]:
                spans = cell.get("seeds", [self.manifest.suite["seeds"]])
                yield cell["key"], {seed for span in spans for seed in range(*span)}

    def missing(self) -> Iterator[tuple[str, list[int]]]:
        """(key, seeds) of the cells that can be run and are not stored whole.

        Raises CorruptPartError where a part is damaged.
        """
        for key, seeds in self.wanted():
            if lacking := sorted(seeds - self.done(key)):
                yield key, lacking

    @contextmanager
    def writing(self) -> Iterator[None]:
        """Hold the folder as its only writer; leftovers are removed before and after.

        Raises RunConflictError where another process writes it.
        """
        with locked(self.path):
            self._sweep()
            try:
                yield
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


def _is_free(folder: Path) -> bool:
    return all(p.name in LOCKS or p.name.startswith(TEMPORARY) for p in folder.iterdir())


def _write(path: Path, text: str) -> None:
    temporary = path.with_name(TEMPORARY + path.name)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with temporary.open("w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    except OSError as error:
        raise StoreError(f"{path} must be writable. The system says: {error.strerror}.") from error


def _difference(held: Manifest, asked: Manifest) -> str:
    keys = [k for k in asked.suite if asked.suite.get(k) != held.suite.get(k)]
    return f" They differ in {', '.join(keys)}." if keys else ""
