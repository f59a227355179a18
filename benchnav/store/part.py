"""A part: the episodes of one cell for a range of seeds, and the values measured on them.

A part is three files, or four where there were rehearsals. The seal is written last and
holds size and sha256 of the others; without a seal there is no part, whatever else a
killed run left there.
"""

import hashlib
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from benchnav.episode.episode import Episode
from benchnav.errors import CorruptPartError
from benchnav.plain_file import open_file, read_file
from benchnav.store import checked_json
from benchnav.store.episodes import from_table
from benchnav.store.results import completed
from benchnav.store.spans import SEED_DIGITS

SEAL = ".seal.json"
EPISODES_FILE = ".episodes.parquet"
RESULTS_FILE = ".results.parquet"
REHEARSALS_FILE = ".rehearsals.parquet"  # only where there were rehearsals
_STEM = re.compile(rf"([0-9]{{6,{SEED_DIGITS}}})-([0-9]{{6,{SEED_DIGITS}}})")
FILES = (EPISODES_FILE, RESULTS_FILE, REHEARSALS_FILE)
MOST_SEEDS = 1_000_000  # of a part, whatever its name says
MOST_SEAL = 1 << 20  # bytes
MOST_BYTES = 8 << 30  # that a file of a part may hold once it is decompressed
_UNDECODABLE = (
    KeyError, TypeError, ValueError, IndexError, AttributeError, OverflowError, RecursionError,
)  # fmt: skip


@dataclass(frozen=True, order=True)
class Part:
    """Seeds first … stop - 1 of the cell whose folder is ``folder``."""

    folder: Path
    first: int
    stop: int

    @property
    def stem(self) -> str:
        """What the names of its files start with."""
        return f"{self.first:06d}-{self.stop:06d}"

    def path(self, suffix: str) -> Path:
        """One of its files."""
        return self.folder / f"{self.stem}{suffix}"

    @property
    def seeds(self) -> range:
        """The seeds that it holds."""
        return range(self.first, self.stop)

    @property
    def sealed(self) -> bool:
        """True once it is complete on disk."""
        return self.path(SEAL).exists()

    def results(self) -> pa.Table:
        """Its measured values. Raises CorruptPartError."""
        return completed(self._table(RESULTS_FILE))

    def episodes(self) -> Iterator[Episode]:
        """Its scored episodes, by seed. Raises CorruptPartError."""
        yield from self._episodes(EPISODES_FILE)

    def rehearsals(self) -> Iterator[Episode]:
        """The rehearsals of its episodes, by seed; none where none were made.

        Raises CorruptPartError.
        """
        if REHEARSALS_FILE in self._seal():
            yield from self._episodes(REHEARSALS_FILE)

    def check(self) -> None:
        """Raise CorruptPartError where a file is missing or has another size than was sealed."""
        for suffix in (EPISODES_FILE, RESULTS_FILE):
            self._check_size(suffix, self._sealed(suffix))
        if REHEARSALS_FILE in self._seal():
            self._check_size(REHEARSALS_FILE, self._sealed(REHEARSALS_FILE))

    def _episodes(self, suffix: str) -> Iterator[Episode]:
        table = self._table(suffix)
        try:
            yield from from_table(table)
        except _UNDECODABLE as error:
            raise self._corrupt(self.path(suffix), f"cannot be decoded ({error})") from error

    def _table(self, suffix: str) -> pa.Table:
        path, sealed = self.path(suffix), self._sealed(suffix)
        self._check_size(suffix, sealed)
        with open_file(path) as file:
            found = hashlib.file_digest(file, "sha256").hexdigest()
        if found != sealed["sha256"]:
            raise self._corrupt(
                path, f"has sha256 {found[:12]}…, sealed was {sealed['sha256'][:12]}…"
            )
        try:
            self._refuse_bomb(path)
            table = pq.read_table(path, partitioning=None)
            keys = [
                (key, "ascending") for key in ("seed", "rehearsal") if key in table.column_names
            ]
            return table.take(pc.sort_indices(table, keys))  # stable: batches may be out of order
        except (OSError, pa.ArrowException) as error:
            raise self._corrupt(path, f"is no Parquet file ({error})") from error

    def _refuse_bomb(self, path: Path) -> None:
        """A small file may decompress to more than memory holds."""
        found = pq.read_metadata(path)
        for group in map(found.row_group, range(found.num_row_groups)):
            columns = [group.column(c) for c in range(group.num_columns)]
            size = sum(max(c.total_uncompressed_size, 8 * c.num_values) for c in columns)
            if size > MOST_BYTES:
                raise self._corrupt(path, f"holds {size} bytes, more than {MOST_BYTES}")

    def _sealed(self, suffix: str) -> dict[str, Any]:
        try:
            sealed = self._seal()[suffix]
            return {"bytes": int(sealed["bytes"]), "sha256": str(sealed["sha256"])}
        except (ValueError, KeyError, TypeError) as error:
            raise self._corrupt(self.path(SEAL), f"cannot be read ({error})") from error

    def _seal(self) -> dict[str, Any]:
        seal = self.path(SEAL)
        try:
            said = checked_json.load(read_file(seal, MOST_SEAL).decode(), (*FILES, "episodes"))
        except (OSError, ValueError, RecursionError) as error:
            raise self._corrupt(seal, f"cannot be read ({error})") from error
        if said.get("episodes") != len(self.seeds):
            raise self._corrupt(seal, f"is of {said.get('episodes')} episodes")
        return said

    def _check_size(self, suffix: str, sealed: dict[str, Any]) -> None:
        path = self.path(suffix)
        if not path.exists():
            raise self._corrupt(path, "is missing")
        if path.stat().st_size != sealed["bytes"]:
            raise self._corrupt(
                path, f"has {path.stat().st_size} bytes, sealed were {sealed['bytes']}"
            )

    def _corrupt(self, path: Path, what: str) -> CorruptPartError:
        run = self.folder.parent.parent
        return CorruptPartError(
            f"{path} must be what was written. It {what}."
            f" Delete {self.path(SEAL)} and run the same suite again with --out {run}"
            " to redo only this part."
        )


def parts_of(folder: Path) -> list[Part]:
    """The sealed parts in the folder of one cell, by seed."""
    stems = (_STEM.fullmatch(seal.name.removesuffix(SEAL)) for seal in folder.glob(f"*{SEAL}"))
    found = sorted(Part(folder, int(stem[1]), int(stem[2])) for stem in stems if stem)
    return [part for part in found if 0 < len(part.seeds) <= MOST_SEEDS]
