"""A run as one file, to give to others: ``.bnrun``.

A zip archive of the run folder's files, uncompressed (Parquet is compressed already), with an
index of size and sha256 of every member first. The same run gives the same bytes.
"""

import hashlib
import json
import os
import re
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path
from zipfile import ZIP_STORED, ZipFile, ZipInfo

from benchnav.errors import StoreError, UsageError
from benchnav.store.parts.part import FILES, SEAL, parts_of
from benchnav.store.runs.lock import claimed
from benchnav.store.runs.manifest import MANIFEST
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.scenario_files import FOLDER, sha256_of
from benchnav.store.runs.spans import SEED_DIGITS

SUFFIX = ".bnrun"
INDEX = "index.json"
FORMAT = 1  # of the archive
MAX_MEMBERS = 100_000  # about 33,000 parts
_EPOCH = (1980, 1, 1, 0, 0, 0)  # the earliest date in zip files: a pack holds no creation time
_SEED = rf"[0-9]{{6,{SEED_DIGITS}}}"
_SUFFIXES = "|".join(re.escape(suffix) for suffix in (*FILES, SEAL))
MEMBER = re.compile(
    rf"{re.escape(MANIFEST)}|{FOLDER}/[0-9a-f]{{64}}"
    rf"|parts/[A-Za-z0-9@_-][A-Za-z0-9@._-]{{0,250}}/{_SEED}-{_SEED}(?:{_SUFFIXES})"
)
"""Allowed names of members: none of them leaves the folder."""


def members(run: RunFolder) -> Iterator[str]:
    """Yield the names of all files of a run, relative to its folder."""
    yield MANIFEST
    named = suite_files(run)
    yield from sorted(f"{FOLDER}/{sha}" for sha in named)
    cells = [cell["key"] for cell in run.manifest.cells if not cell["reason"]]
    for part in (part for key in cells for part in parts_of(run.cell(key))):
        for suffix in (*FILES, SEAL):
            if part.path(suffix).exists():
                yield f"parts/{part.folder.name}/{part.stem}{suffix}"


def suite_files(run: RunFolder) -> set[str]:
    """Return the sha256 of the files that the scenarios of a run name."""
    return {
        sha
        for scenario in run.manifest.suite.get("scenarios", ())
        for sha in scenario.get("files", {}).values()
    }


def content(run: RunFolder) -> dict[str, dict[str, int | str]]:
    """Return size and sha256 of every member. Raises StoreError if one is missing or unusual."""
    found: dict[str, dict[str, int | str]] = {}
    for name in sorted(members(run)):
        path = run.path / name
        if MEMBER.fullmatch(name) is None or not path.is_file() or path.is_symlink():
            raise StoreError(
                f"{run.shown / name} must be a file of a run, made by this version. It is not:"
                " run the same suite again."
            )
        found[name] = {"bytes": path.stat().st_size, "sha256": sha256_of(path)}
    return found


def content_digest(run: RunFolder) -> str:
    """Return the sha256 of a run's content, equal for a folder and its pack."""
    return digest_of({name: str(facts["sha256"]) for name, facts in content(run).items()})


def digest_of(sums: Mapping[str, str]) -> str:
    """Return the same digest from the sha256 of each member by name."""
    lines = [f"{sums[name]} {name}\n" for name in sorted(sums)]
    return hashlib.sha256("".join(lines).encode()).hexdigest()


def pack(run: RunFolder, out: Path) -> None:
    """Write the pack of a run to ``out``.

    Raises:
        UsageError: ``out`` exists already, a scenario's file has an absolute path, or
            there are too many files.
        RunConflictError: another process writes ``out``.
        StoreError: a file of the run is missing, or the disk refuses.
    """
    _refuse_existing(out)
    _refuse_absolute_paths(run)
    for part in run.parts():
        part.check_rows()
    found = content(run)
    if len(found) > MAX_MEMBERS:
        raise UsageError(
            f"A pack must have at most {MAX_MEMBERS} files. {run.path} has {len(found)}: run its"
            " scenarios as several suites."
        )
    index = json.dumps({"format": FORMAT, "files": found}, indent=1, sort_keys=True)
    temporary = out.with_name(f".writing-{out.name}")
    try:
        with claimed(temporary):
            _refuse_existing(out)  # another process wrote it meanwhile
            with ZipFile(temporary, "w", ZIP_STORED) as archive:
                archive.writestr(_info(INDEX, len(index)), index)
                for name, facts in found.items():
                    _copy(run.path / name, archive, _info(name, int(facts["bytes"])))
            with temporary.open("rb") as file:
                os.fsync(file.fileno())
            temporary.replace(out)
    except OSError as error:
        raise StoreError(f"{out} is not writable: {error.strerror}.") from error


def _refuse_existing(out: Path) -> None:
    if out.exists():
        raise UsageError(f"{out} must be a new file. It exists already.")


def _refuse_absolute_paths(run: RunFolder) -> None:
    for scenario in run.manifest.suite.get("scenarios", ()):
        for name in scenario.get("files", ()):
            if Path(name).is_absolute():
                raise UsageError(
                    f"The scenario {scenario['scenario']} must name its files relative to its own"
                    f" file, to be packed. Got {name!r}; use a relative name and run again."
                )


def _info(name: str, size: int) -> ZipInfo:
    info = ZipInfo(name, _EPOCH)
    info.create_system = 3  # constant, for equal bytes on every system
    info.external_attr = 0o100644 << 16
    info.file_size = size
    return info


def _copy(source: Path, archive: ZipFile, info: ZipInfo) -> None:
    with source.open("rb") as file, archive.open(info, "w") as target:
        shutil.copyfileobj(file, target, 1 << 20)
