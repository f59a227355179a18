"""Write one part: all files under temporary names, then rename them, the seal last."""

import hashlib
import os
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, Self

import pyarrow as pa
import pyarrow.parquet as pq

from benchnav.episode.episode import Episode
from benchnav.errors import CorruptPartError, StoreError
from benchnav.store.parts.episodes import DICTIONARY, to_table
from benchnav.store.parts.part import Part
from benchnav.store.parts.results import RESULTS, stored_form
from benchnav.store.parts.seal import (
    EPISODES_FILE,
    FILES,
    REHEARSALS_FILE,
    RESULTS_FILE,
    SEAL,
    read_seal,
)
from benchnav.store.runs import checked_json

TEMPORARY = ".writing-"  # prefix of the names of unfinished files


@dataclass(frozen=True)
class _Stream:
    file: IO[bytes]
    writer: pq.ParquetWriter


class EpisodeFiles:
    """The files of a part's episodes and rehearsals, under temporary names; `seal` comes later.

    Every method raises StoreError if the disk refuses (full, read-only).
    """

    def __init__(self, part: Part) -> None:
        self.part = part
        self._finished = False
        self._streams: dict[str, _Stream] = {}

    def add(self, episodes: Sequence[Episode], rehearsals: Sequence[Episode] = ()) -> None:
        """Append scored episodes, and the rehearsals of some."""
        for suffix, chosen in ((EPISODES_FILE, episodes), (REHEARSALS_FILE, rehearsals)):
            if chosen:
                self._write(suffix, to_table(chosen))

    def _write(self, suffix: str, table: pa.Table) -> None:
        try:
            if suffix not in self._streams:
                self._open(suffix, table.schema)
            self._streams[suffix].writer.write_table(table)
        except OSError as error:
            raise not_writable(self.part, error) from error

    def finish(self) -> None:
        """Complete the files, and flush them to disk."""
        try:
            for stream in self._streams.values():
                stream.writer.close()
                _sync(stream.file)
        except OSError as error:
            raise not_writable(self.part, error) from error
        self._finished = True

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        if self._finished and exception[1] is None:
            return
        for stream in self._streams.values():
            with suppress(OSError, pa.ArrowException):  # the first error is being raised already
                stream.writer.close()
            with suppress(OSError):
                stream.file.close()
        discard(self.part)

    def _open(self, suffix: str, schema: pa.Schema) -> None:
        self.part.folder.mkdir(parents=True, exist_ok=True)
        file = temporary(self.part, suffix).open("wb")
        writer = pq.ParquetWriter(
            file, schema, compression="zstd", use_dictionary=DICTIONARY,
            write_statistics=["seed"],
        )  # fmt: skip
        self._streams[suffix] = _Stream(file, writer)


class PartWriter:
    """Collects batches of episodes of a part; readers see no file before `seal`.

    Every method raises StoreError if the disk refuses (full, read-only).
    """

    def __init__(self, part: Part) -> None:
        self.part = part
        self._files = EpisodeFiles(part)
        self._results: list[pa.Table] = []
        self._rows = 0
        self._sealed = False

    def add(
        self, episodes: Sequence[Episode], results: pa.Table, rehearsals: Sequence[Episode] = ()
    ) -> None:
        """Append scored episodes, the table of `RESULTS` measured on them, and rehearsals."""
        self._files.add(episodes, rehearsals)
        self._rows += len(episodes)
        self._results.append(results)

    def seal(self) -> None:
        """Make the part visible, complete and durable."""
        self._files.finish()
        seal(self.part, pa.concat_tables([RESULTS.empty_table(), *self._results]), self._rows)
        self._sealed = True

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self._files.__exit__(*exception)
        if not self._sealed:
            discard(self.part)


def seal(part: Part, results: pa.Table, episodes: int) -> None:
    """Make a part visible whose `EpisodeFiles` are finished, with the values measured on them.

    Raises StoreError if the disk refuses.
    """
    try:
        with temporary(part, RESULTS_FILE).open("wb") as file:
            pq.write_table(stored_form(results), file, compression="zstd")
            _sync(file)
        written = [suffix for suffix in FILES if temporary(part, suffix).exists()]
        sealed = {suffix: _facts(temporary(part, suffix)) for suffix in written}
        with temporary(part, SEAL).open("wb") as file:
            file.write(checked_json.dump({**sealed, "episodes": episodes}).encode())
            _sync(file)
        for suffix in (*written, SEAL):
            temporary(part, suffix).replace(part.path(suffix))
        _sync_folder(part.folder)
    except OSError as error:
        discard(part)
        raise not_writable(part, error) from error


def discard(part: Part) -> None:
    """Remove the unsealed files of a part."""
    for suffix in (*FILES, SEAL):
        with suppress(OSError):
            temporary(part, suffix).unlink(missing_ok=True)


def temporary(part: Part, suffix: str) -> Path:
    """Return the temporary path of a part's file."""
    return part.folder / f"{TEMPORARY}{part.stem}{suffix}"


def receive(part: Part, files: Mapping[str, bytes]) -> None:
    """Store a part that was written elsewhere; ``files`` are its files by suffix.

    Raises StoreError if the disk refuses, CorruptPartError if a file differs from its seal.
    """
    _refuse_unsealed(part, files)
    written = [suffix for suffix in (*FILES, SEAL) if suffix in files]  # the seal last
    temporary = {suffix: part.folder / f"{TEMPORARY}{part.stem}{suffix}" for suffix in written}
    try:
        part.folder.mkdir(parents=True, exist_ok=True)
        for suffix, path in temporary.items():
            with path.open("wb") as file:
                file.write(files[suffix])
                _sync(file)
        for suffix, path in temporary.items():
            path.replace(part.path(suffix))
        _sync_folder(part.folder)
    except OSError as error:
        raise not_writable(part, error) from error
    finally:
        for path in temporary.values():
            with suppress(OSError):
                path.unlink(missing_ok=True)


def _refuse_unsealed(part: Part, files: Mapping[str, bytes]) -> None:
    try:
        seal = read_seal(files[SEAL].decode(), len(part.seeds))
        sealed = {suffix: facts["sha256"] for suffix, facts in seal.items()}
    except (KeyError, ValueError) as error:
        raise CorruptPartError(f"{part.path(SEAL)} is damaged. It cannot be read.") from error
    found = {
        suffix: hashlib.sha256(files[suffix]).hexdigest() for suffix in files if suffix != SEAL
    }
    if sealed != found:
        raise CorruptPartError(f"{part.path(SEAL)} does not match the files that came with it.")


def not_writable(part: Part, error: OSError) -> StoreError:
    """Return the error for a disk that refuses."""
    run = part.folder.parent.parent
    return StoreError(
        f"{part.folder} is not writable, or the disk is full:"
        f" {error.strerror or error}."
        " Every finished part is safe; free some space and run the same suite again"
        f" into {run} to continue."
    )


def _sync(file: Any) -> None:
    file.flush()
    os.fsync(file.fileno())
    file.close()


def _sync_folder(folder: Path) -> None:
    if not hasattr(os, "O_DIRECTORY"):  # Windows cannot open folders
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _facts(path: Path) -> dict[str, Any]:
    with path.open("rb") as file:
        found = hashlib.file_digest(file, "sha256").hexdigest()
    return {"bytes": path.stat().st_size, "sha256": found}
