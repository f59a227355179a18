"""The files of a folder that count as source, in bounded time."""

import hashlib
import os
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

from benchnav.system.plain_file import open_file

MAX_FILES = 5_000  # of a folder
MAX_BYTES = 4 << 30  # of a file; of a larger file, its size and this many bytes count
_SKIPPED = {"__pycache__", "tests", "test", "node_modules", "site-packages"}
_NOT_SOURCE = (
    ".pyc", ".pyo", ".pyi", ".md", ".rst", ".typed", ".log", ".nbi", ".nbc", ".kernel", "~", ".swp",
)  # fmt: skip


def files_below(folder: Path) -> Iterator[Path]:
    """Yield the source files below ``folder``, at most `MAX_FILES`, sorted within each folder."""
    yield from islice(_walk(folder), MAX_FILES)


def data_of(package: Path) -> Iterator[Path]:
    """Yield the files of a package folder that are not Python, without those of its subpackages."""
    found = (path for path in _walk(package, within=True) if path.suffix != ".py")
    yield from islice(found, MAX_FILES)


def digest_of(file: Path) -> str:
    """Return the sha256 of a file."""
    size = file.stat().st_size
    with open_file(file) as opened:
        if size <= MAX_BYTES:
            return hashlib.file_digest(opened, "sha256").hexdigest()
        digest, left = hashlib.sha256(str(size).encode()), MAX_BYTES
        while left and (piece := opened.read(min(left, 1 << 20))):
            digest.update(piece)
            left -= len(piece)
        return digest.hexdigest()


def _walk(top: Path, within: bool = False) -> Iterator[Path]:
    """Yield the files that count; ``within`` excludes subpackages. Each link is followed once."""
    visited: set[str] = set()
    for folder, folders, names in os.walk(top, followlinks=True):
        here = Path(folder)
        folders[:] = sorted(name for name in folders if _counts(here / name, within, visited))
        for name in sorted(names):
            path = here / name
            if not name.startswith(".") and not name.endswith(_NOT_SOURCE) and path.is_file():
                yield path


def _counts(folder: Path, within: bool, visited: set[str]) -> bool:
    name = folder.name
    if name in _SKIPPED or name.startswith(".") or name.endswith((".egg-info", ".dist-info")):
        return False
    if (folder / "pyvenv.cfg").exists() or (folder / "conda-meta").exists():
        return False
    if (folder / "manifest.json").exists() and (folder / "parts").is_dir():
        return False  # a run folder, perhaps of this navigator
    if within and (folder / "__init__.py").exists():
        return False
    real = os.path.realpath(folder)
    visited_before = real in visited
    visited.add(real)
    return not visited_before
