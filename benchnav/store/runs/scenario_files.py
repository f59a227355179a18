"""The files that scenarios of a run name (maps, meshes, tracks), stored with the run.

Each is named by the sha256 of its bytes, so that no name in a scenario becomes a
path here; the manifest maps scenario names to these. Without them, others could
not draw the worlds again.
"""

import hashlib
import os
import re
from collections.abc import Mapping
from pathlib import Path, PurePosixPath

from benchnav.errors import CorruptPartError, StoreError
from benchnav.system.plain_file import open_file

FOLDER = "files"
UP = 8  # levels that a name in a scenario may climb above the scenario's folder
_SHA = re.compile(r"[0-9a-f]{64}")


def sha256_of(path: Path) -> str:
    """Return the hexadecimal sha256 of a file's bytes."""
    with open_file(path) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def keep_files(run: Path, files: Mapping[str, Path]) -> None:
    """Copy missing files into the run. Raises StoreError if the disk refuses."""
    for source in files.values():
        content = source.read_bytes()
        target = run / FOLDER / hashlib.sha256(content).hexdigest()
        if target.exists():
            continue
        temporary = target.with_name(f".writing-{target.name}")
        try:
            target.parent.mkdir(exist_ok=True)
            temporary.write_bytes(content)
            temporary.replace(target)
        except OSError as error:
            raise StoreError(f"{target} is not writable: {error.strerror}.") from error


def stage_files(run: Path, files: Mapping[str, str], root: Path) -> Path:
    """Copy stored files under their scenario names into ``root``; return their base folder.

    Raises CorruptPartError if a file is missing or was changed, or a name leaves ``root``.
    """
    folder = root.joinpath(*("_" * UP))
    folder.mkdir(parents=True)
    for name, sha in files.items():
        target = _inside(root, folder, name)
        source = run / FOLDER / (sha if _SHA.fullmatch(sha) else "?")
        if not source.is_file():
            raise CorruptPartError(
                f"{run / FOLDER} must hold the file {name!r} of a scenario, called"
                f" {sha[:64]!r}. It is missing."
            )
        content = source.read_bytes()
        if hashlib.sha256(content).hexdigest() != sha:
            raise CorruptPartError(f"{source} is damaged. It was changed.")
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)
    return folder


def _inside(root: Path, folder: Path, name: str) -> Path:
    relative = PurePosixPath(name)
    target = Path(os.path.normpath(folder.joinpath(*relative.parts)))
    strange = "\\" in name or "\0" in name or ":" in name or relative.is_absolute()
    if strange or not target.is_relative_to(root) or folder.is_relative_to(target):
        raise CorruptPartError(
            f"A scenario's file must be named relative to the scenario's own, at most {UP}"
            f" folders up, so that others can find it. Got {name[:100]!r}."
        )
    return target
