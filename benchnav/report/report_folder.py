"""The folder of a report: written beside its place, then moved there."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from benchnav.errors import StoreError, UsageError
from benchnav.store.runs.manifest import MANIFEST, versions

MARKER = "report.json"  # names the files and folders of a report, so that it can be replaced
_KIND = "benchnav report"
_PREFIX = ".benchnav-report-"


def require_replaceable(out: Path) -> None:
    """Raise UsageError if ``out`` holds something else than a report, or is part of a run."""
    for folder in (out.absolute(), *out.absolute().parents):
        if (folder / MANIFEST).is_file() and (folder / "parts").is_dir():
            raise UsageError(
                f"A report must not be written into a run. {out} is part of the run {folder}."
                " Choose another folder."
            )
    if not out.exists() and not out.is_symlink():
        return
    if not out.is_dir():
        raise UsageError(f"{out} must be a folder, or not exist. It is a file: choose a folder.")
    others = sorted(_names(out) - _own_names(out))
    if others:
        raise UsageError(
            f"{out} must be empty, missing, or hold an earlier report and nothing else. It holds"
            f" {_listed(others)}. Choose another folder."
        )


@contextmanager
def replaced_folder(out: Path) -> Iterator[Path]:
    """Yield a new folder, which takes the place of ``out`` when the block ends without an error.

    Raises StoreError if the disk refuses.
    """
    target = out.resolve()
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(prefix=_PREFIX, dir=target.parent))
        try:
            yield folder
            _mark(folder)
            folder.chmod(0o777 & ~_umask())
            _move(folder, target)
        finally:
            shutil.rmtree(folder, ignore_errors=True)
    except OSError as error:
        reason = error.strerror or error
        raise StoreError(
            f"The report {out} must be writable. The system says: {reason}. Choose another"
            " folder, or free space."
        ) from error


def _move(folder: Path, target: Path) -> None:
    """Move ``folder`` to ``target``; an earlier report there is removed."""
    if not target.exists():
        folder.replace(target)
        return
    old = Path(tempfile.mkdtemp(prefix=_PREFIX, dir=target.parent))
    target.replace(old)  # an empty folder may be replaced
    try:
        folder.replace(target)
    except OSError:
        old.replace(target)
        raise
    shutil.rmtree(old, ignore_errors=True)


def _mark(folder: Path) -> None:
    names = sorted({*_names(folder), MARKER})
    content = {"kind": _KIND, "benchnav": versions().get("benchnav", ""), "names": names}
    (folder / MARKER).write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def _own_names(out: Path) -> set[str]:
    """Return the names that belong to an earlier report in ``out``; none if there is none."""
    try:
        content = json.loads((out / MARKER).read_text(encoding="utf-8"))
        return set(content["names"]) if content["kind"] == _KIND else set()
    except (OSError, ValueError, KeyError, TypeError):
        return set()


def _names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def _listed(names: list[str]) -> str:
    few = ", ".join(names[:3])
    return few if len(names) <= 3 else f"{few} and {len(names) - 3} more"


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
