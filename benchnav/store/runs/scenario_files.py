"""The files that scenarios of a run name (maps, meshes, tracks), kept with the run.

They are called by the sha256 of their bytes, so that no name of the scenario's becomes a
path here; the manifest says which name stands for which. Without them a stranger could
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
UP = 8  # levels that a scenario's names may climb above its own folder
_SHA = re.compile(r"[0-9a-f]{64}")


def sha256_of(path: Path) -> str:
    """Hexadecimal sha256 of a file's bytes."""
    with open_file(path) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def keep_files(run: Path, files: Mapping[str, Path]) -> None:
    """Copy what is not there yet into the run. Raises StoreError where the disk refuses."""
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
            raise StoreError(
                f"{target} must be writable. The system says: {error.strerror}."
            ) from error


def stage_files(run: Path, files: Mapping[str, str], root: Path) -> Path:
    """Put kept files under their names into ``root``; the folder that those are relative to.

    Raises CorruptPartError where a file lacks or was changed, or a name leads out of ``root``.
    """
    folder = root.joinpath(*("_" * UP))
    folder.mkdir(parents=True)
    for name, sha in files.items():
        target = _inside(root, folder, name)
        source = run / FOLDER / (sha if _SHA.fullmatch(sha) else "?")
        if not source.is_file():
            raise CorruptPartError(
                f"{run / FOLDER} must hold the file {name!r} of a scenario, called"
                f" {sha[:64]!r}. It lacks."
            )
        content = source.read_bytes()
        if hashlib.sha256(content).hexdigest() != sha:
            raise CorruptPartError(f"{source} must be what was written. It was changed.")
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)
    return folder


def _inside(root: Path, folder: Path, name: str) -> Path:
    said = PurePosixPath(name)
    target = Path(os.path.normpath(folder.joinpath(*said.parts)))
    strange = "\\" in name or "\0" in name or ":" in name or said.is_absolute()
    if strange or not target.is_relative_to(root) or folder.is_relative_to(target):
        raise CorruptPartError(
            f"A scenario's file must be named relative to the scenario's own, at most {UP}"
            f" folders up, for somebody else to find it. Got {name[:100]!r}."
        )
    return target
