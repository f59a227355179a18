"""Runs from folders and from packs. A pack comes from a stranger: nothing in it is believed."""

import hashlib
import json
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from zipfile import ZIP_STORED, BadZipFile, ZipFile, ZipInfo

from benchnav.errors import CorruptPartError, NoRunError, StoreError
from benchnav.store.manifest import load_manifest
from benchnav.store.pack import FORMAT, INDEX, MEMBER
from benchnav.store.run_folder import RunFolder
from benchnav.store.run_path import RunPath, run_path
from benchnav.temporary_folder import TemporaryFolder

MOST_MEMBERS = 1_000_000
_ZIP = b"PK"  # with which every zip archive begins
MOST_INDEX = 256 << 20  # bytes


@contextmanager
def opened(path: RunPath) -> Iterator[RunFolder]:
    """A run for reading: a folder as it is, a pack unpacked for as long as this lasts.

    Raises:
        NoRunError: there is no run, and the file is not a pack.
        StoreError: the file cannot be read, or another version made the pack.
        CorruptPartError: the pack, or its manifest, is not what was written.
    """
    path = run_path(path)
    if not path.is_file():
        yield RunFolder.open(path)
        return
    with TemporaryFolder("pack") as temporary:
        folder = temporary.path
        try:
            unpack(path, folder)
            yield RunFolder(folder, load_manifest(folder), path)
        except StoreError as error:
            raise type(error)(str(error).replace(str(folder), str(path))) from error


def unpack(path: Path, folder: Path) -> None:
    """Write the members of a pack into ``folder``, each only if it is what the index says."""
    try:
        _refuse_other_files(path)
        with ZipFile(path) as archive:
            infos = archive.infolist()
            _refuse_strange(path, infos)
            said = _index(path, archive, infos)
            for info in infos[1:]:
                _extract(path, archive, info, said[info.filename], folder)
    except (BadZipFile, NotImplementedError, EOFError, OSError, RuntimeError) as error:
        raise StoreError(
            f"{path} must be a run folder, or a pack that 'benchnav pack' made."
            f" It cannot be read: {error}."
        ) from error


def _refuse_other_files(path: Path) -> None:
    with path.open("rb") as file:
        if not file.read(len(_ZIP)).startswith(_ZIP):
            raise NoRunError(
                f"{path} must be a run folder, or a pack that 'benchnav pack' made. It is neither."
            )


def _refuse_strange(path: Path, infos: list[ZipInfo]) -> None:
    """Before a byte is written: names, kinds and sizes."""
    if not infos or infos[0].filename != INDEX:
        raise NoRunError(f"{path} must be a pack that 'benchnav pack' made. It has no {INDEX}.")
    if len(infos) > MOST_MEMBERS:
        raise _corrupt(path, f"has {len(infos)} members, more than {MOST_MEMBERS}")
    names = [info.filename for info in infos]
    for info in infos:
        kind = stat.S_IFMT(info.external_attr >> 16)
        if info.filename != INDEX and MEMBER.fullmatch(info.filename) is None:
            raise _corrupt(path, f"has a member {info.filename[:100]!r}, which no run has")
        if kind not in (0, stat.S_IFREG):
            raise _corrupt(path, f"has a member {info.filename!r} that is not a plain file")
        if info.compress_type != ZIP_STORED or info.file_size != info.compress_size:
            raise _corrupt(path, f"has a member {info.filename!r} that is compressed")
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise _corrupt(path, f"has {twice!r} twice")
    if sum(info.file_size for info in infos) > path.stat().st_size:
        raise _corrupt(path, "has members that are larger than itself")


def _index(path: Path, archive: ZipFile, infos: list[ZipInfo]) -> Mapping[str, Any]:
    if infos[0].file_size > MOST_INDEX:
        raise _corrupt(path, f"has an {INDEX} of {infos[0].file_size} bytes")
    try:
        said = json.loads(archive.read(infos[0]))
        if said["format"] != FORMAT:
            raise StoreError(
                f"{path}: the format must be {FORMAT}. Got {said['format']!r} instead: another"
                " version of benchnav made it."
            )
        files: Mapping[str, Any] = said["files"]
        whole = set(files) == {info.filename for info in infos[1:]}
        whole &= all(files[info.filename]["bytes"] == info.file_size for info in infos[1:])
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise _corrupt(path, f"has an {INDEX} that cannot be read ({error})") from error
    if not whole:
        raise _corrupt(path, f"has other members, or of other sizes, than its {INDEX} says")
    return files


def _extract(
    path: Path, archive: ZipFile, info: ZipInfo, facts: Mapping[str, Any], folder: Path
) -> None:
    target = folder / info.filename
    target.parent.mkdir(parents=True, exist_ok=True)
    hashed, size = hashlib.sha256(), 0
    with archive.open(info) as source, target.open("xb") as file:
        while piece := source.read(1 << 20):
            size += len(piece)
            if size > info.file_size:
                raise _corrupt(path, f"has a member {info.filename!r} larger than it says")
            hashed.update(piece)
            file.write(piece)
    if size != info.file_size or hashed.hexdigest() != facts["sha256"]:
        raise _corrupt(path, f"has a member {info.filename!r} with another sha256 than indexed")


def _corrupt(path: Path, what: str) -> CorruptPartError:
    return CorruptPartError(f"{path} must be what 'benchnav pack' wrote. It {what}.")
