"""A part: the episodes of one cell for a range of seeds, and the values measured on them.

A part is three files, or four where there were rehearsals. The seal is written last and
holds size and sha256 of the others; without a seal there is no part, whatever else a
killed run left there.
"""

import hashlib
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from benchnav.episode.episode import Episode
from benchnav.errors import CorruptPartError, ForeignRowError
from benchnav.store import checked_json
from benchnav.store.episodes import from_table
from benchnav.store.membership import Membership
from benchnav.store.results import completed

SEAL = ".seal.json"
EPISODES_FILE = ".episodes.parquet"
RESULTS_FILE = ".results.parquet"
REHEARSALS_FILE = ".rehearsals.parquet"  # only where there were rehearsals
_STEM = re.compile(r"([0-9]{6,9})-([0-9]{6,9})")
FILES = (EPISODES_FILE, RESULTS_FILE, REHEARSALS_FILE)
MOST_SEEDS = 1_000_000  # of a part, whatever its name says
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
    membership: Membership | None = field(default=None, compare=False, repr=False)

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

    def check_rows(self) -> None:
        """Raise CorruptPartError where a file is not as sealed, or a row is not of the part."""
        self.results()
        self._table(EPISODES_FILE)
        if REHEARSALS_FILE in self._seal():
            self._table(REHEARSALS_FILE)

    def _episodes(self, suffix: str) -> Iterator[Episode]:
        table = self._table(suffix)
        try:
            yield from from_table(table)
        except _UNDECODABLE as error:
            raise self._corrupt(self.path(suffix), f"cannot be decoded ({error})") from error

    def _table(self, suffix: str) -> pa.Table:
        path, sealed = self.path(suffix), self._sealed(suffix)
        self._check_size(suffix, sealed)
        content = path.read_bytes()  # what is decoded are the bytes that are hashed
        found = hashlib.sha256(content).hexdigest()
        if found != sealed["sha256"]:
            raise self._corrupt(
                path, f"has sha256 {found[:12]}…, sealed was {sealed['sha256'][:12]}…"
            )
        try:
            self._refuse_bomb(content, path)
            table = pq.read_table(pa.BufferReader(content), partitioning=None)
            self._refuse_foreign(suffix, table)
            keys = [
                (key, "ascending") for key in ("seed", "rehearsal") if key in table.column_names
            ]
            return table.take(pc.sort_indices(table, keys))  # stable: batches may be out of order
        except (OSError, pa.ArrowException) as error:
            raise self._corrupt(path, f"is no Parquet file ({error})") from error

    def _refuse_foreign(self, suffix: str, table: pa.Table) -> None:
        """Raise CorruptPartError where a row is of another cell, or of a seed that is not here."""
        if self.membership is None:
            return
        try:
            self.membership.require_rows(table, self.seeds, scored=suffix != REHEARSALS_FILE)
        except ValueError as error:
            raise ForeignRowError(str(self._corrupt(self.path(suffix), str(error)))) from error

    def _refuse_bomb(self, content: bytes, path: Path) -> None:
        """A small file may decompress to more than memory holds."""
        found = pq.read_metadata(pa.BufferReader(content))
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
            text = seal.read_text(encoding="utf-8")
            self._refuse_another_seal(text)
            said = checked_json.load(text, (*FILES, "episodes"))
        except (OSError, ValueError, RecursionError) as error:
            raise self._corrupt(seal, f"cannot be read ({error})") from error
        if said.get("episodes") != len(self.seeds):
            raise self._corrupt(seal, f"is of {said.get('episodes')} episodes")
        return said

    def _refuse_another_seal(self, text: str) -> None:
        """Raise ValueError where the part was exchanged since its run was pinned."""
        pinned = self.membership.seals if self.membership else {}
        if pinned and pinned.get(self.path(SEAL).name) != hashlib.sha256(text.encode()).hexdigest():
            raise ValueError("it was changed while the run was read")

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
    return named_parts(folder, (seal.name for seal in folder.glob(f"*{SEAL}")))


def named_parts(folder: Path, seals: Iterable[str]) -> list[Part]:
    """The parts that have these seals, by seed."""
    stems = (_STEM.fullmatch(name.removesuffix(SEAL)) for name in seals)
    found = sorted(Part(folder, int(stem[1]), int(stem[2])) for stem in stems if stem)
    return [part for part in found if 0 < len(part.seeds) <= MOST_SEEDS]
