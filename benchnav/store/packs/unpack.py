"""Open runs from folders and from packs. A pack is untrusted: every claim in it is checked."""

import hashlib
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from zipfile import ZIP_STORED, BadZipFile, ZipFile, ZipInfo

from benchnav.config.document import shown
from benchnav.errors import CorruptPartError, NoRunError, StoreError
from benchnav.navigation.command_check import short
from benchnav.store.bounded import bounded_json
from benchnav.store.packs.pack import FORMAT, INDEX, MAX_MEMBERS, MEMBER
from benchnav.store.parts.part import CURE
from benchnav.store.parts.seal import Facts, require_facts
from benchnav.store.runs.manifest import load_manifest
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.run_path import RunPath, run_path
from benchnav.system.temporary_folder import TemporaryFolder

MAX_DIRECTORY = 48 << 20  # bytes; a member takes about 150
_ZIP = b"PK"  # the first bytes of every zip archive
_END, _LOCATOR, _END64 = 22, 20, 76  # [bytes] of the end records; the last two in large archives
MAX_INDEX = 64 << 20  # bytes; a member takes about 170


@contextmanager
def opened(path: RunPath) -> Iterator[RunFolder]:
    """Open a run for reading: a folder as it is; a pack is unpacked inside this context.

    Raises:
        NoRunError: there is no run, and the file is not a pack.
        StoreError: the file cannot be read, or another version made the pack.
        CorruptPartError: the pack or its manifest is damaged.
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
            text, _, _ = str(error).partition(CURE)  # this cure does not apply to a pack
            raise type(error)(text.replace(str(folder), str(path))) from error


def unpack(path: Path, folder: Path) -> None:
    """Write the members of a pack into ``folder``, each only if it matches the index."""
    try:
        _refuse_other_files(path)
        with ZipFile(path) as archive:
            infos = archive.infolist()
            _refuse_strange(path, infos)
            index = _index(path, archive, infos)
            for info in infos[1:]:
                _extract(path, archive, info, index[info.filename], folder)
    except (BadZipFile, NotImplementedError, EOFError, OSError, RuntimeError) as error:
        raise StoreError(
            f"{path} must be a run folder, or a pack of 'benchnav pack'."
            f" It cannot be read: {error}."
        ) from error


def _refuse_other_files(path: Path) -> None:
    """Check the end records before the directory of the archive is read, which may be large."""
    with path.open("rb") as file:
        begin = file.read(len(_ZIP))
        file.seek(max(0, path.stat().st_size - _END64 - _END))
        end = file.read()
    if begin != _ZIP:
        raise NoRunError(
            f"{path} must be a run folder, or a pack of 'benchnav pack'. It is neither."
        )
    size = int.from_bytes(end[12 - _END : 16 - _END], "little")
    if end[-_END - _LOCATOR :].startswith(b"PK\6\7"):  # a large archive: its size is stored before
        size = int.from_bytes(end[40 - _END64 - _END : 48 - _END64 - _END], "little")
    if not end[-_END:].startswith(b"PK\5\6"):
        raise StoreError(
            f"{path} must be a run folder, or a pack of 'benchnav pack'. It is truncated, or"
            " has data after its end."
        )
    if size > MAX_DIRECTORY:
        raise _corrupt(path, f"has a directory of {size} bytes, more than {MAX_DIRECTORY}")


def _refuse_strange(path: Path, infos: list[ZipInfo]) -> None:
    """Check names, kinds and sizes before any byte is written."""
    if not infos or infos[0].filename != INDEX:
        raise NoRunError(f"{path} must be a pack of 'benchnav pack'. It has no {INDEX}.")
    if len(infos) > MAX_MEMBERS:
        raise _corrupt(path, f"has {len(infos)} members, more than {MAX_MEMBERS}")
    earlier: set[str] = set()
    for info in infos:
        kind = stat.S_IFMT(info.external_attr >> 16)
        if info.filename != INDEX and MEMBER.fullmatch(info.filename) is None:
            raise _corrupt(path, f"has an unknown member {info.filename[:100]!r}")
        if kind not in (0, stat.S_IFREG):
            raise _corrupt(path, f"has a member {info.filename!r} that is not a plain file")
        if info.compress_type != ZIP_STORED or info.file_size != info.compress_size:
            raise _corrupt(path, f"has a member {info.filename!r} that is compressed")
        if info.filename in earlier:
            raise _corrupt(path, f"has {info.filename!r} twice")
        earlier.add(info.filename)
    if sum(info.file_size for info in infos) > path.stat().st_size:
        raise _corrupt(path, "has members that are larger than itself")


def _index(path: Path, archive: ZipFile, infos: list[ZipInfo]) -> Mapping[str, Facts]:
    """Return size and sha256 of every other member; members and sizes match the archive."""
    if infos[0].file_size > MAX_INDEX:
        raise _corrupt(path, f"has an {INDEX} of {infos[0].file_size} bytes")
    try:
        index = bounded_json.load(archive.read(infos[0]).decode())
        if not isinstance(index, dict) or "format" not in index:
            raise ValueError(f"it must have the key format; got {shown(index)}")
        if type(index["format"]) is not int or index["format"] != FORMAT:
            raise StoreError(
                f"{path}: the format must be {FORMAT}. Got {shown(index['format'])!r} instead:"
                " another version of benchnav made it."
            )
        if set(index) != {"format", "files"}:
            raise ValueError(f"it must have the keys format and files; got {shown(list(index))}")
        if not isinstance(index["files"], dict):
            raise ValueError(f"its files must be an object; got {shown(index['files'])}")
        files = {name: require_facts(shown(name), f) for name, f in index["files"].items()}
    except ValueError as error:
        raise _corrupt(path, f"has an {INDEX} that cannot be read ({short(error)})") from error
    sizes = {info.filename: info.file_size for info in infos[1:]}
    if {name: facts["bytes"] for name, facts in files.items()} != sizes:
        raise _corrupt(path, f"has other members, or of other sizes, than in its {INDEX}")
    return files


def _extract(path: Path, archive: ZipFile, info: ZipInfo, facts: Facts, folder: Path) -> None:
    target = folder / info.filename
    target.parent.mkdir(parents=True, exist_ok=True)
    hashed, size = hashlib.sha256(), 0
    with archive.open(info) as source, target.open("xb") as file:
        while piece := source.read(1 << 20):
            size += len(piece)
            if size > info.file_size:
                raise _corrupt(path, f"has a member {info.filename!r} larger than announced")
            hashed.update(piece)
            file.write(piece)
    if size != info.file_size or hashed.hexdigest() != facts["sha256"]:
        raise _corrupt(path, f"has a member {info.filename!r} with another sha256 than indexed")


def _corrupt(path: Path, problem: str) -> CorruptPartError:
    return CorruptPartError(f"{path} is not a valid pack of 'benchnav pack'. It {problem}.")
