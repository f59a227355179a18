"""A part: the episodes of one cell for a range of seeds, and the values measured on them.

A part is three files, or four where there were rehearsals. The seal is written last and
holds size and sha256 of the others; without a seal there is no part, whatever else a
killed run left there.
"""

import hashlib
import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc

from benchnav.episode.episode import Episode
from benchnav.errors import CorruptPartError
from benchnav.navigation.answer import short
from benchnav.store import bounded_json, bounded_parquet, results
from benchnav.store.episodes import EPISODES, from_table
from benchnav.store.episodes import LATER as EPISODES_LATER
from benchnav.store.seal import (
    EPISODES_FILE,
    FILES,
    MOST_SEAL,
    REHEARSALS_FILE,
    RESULTS_FILE,
    SEAL,
    Facts,
    read_seal,
)

__all__ = [
    "EPISODES_FILE", "FILES", "MOST_SEEDS", "REHEARSALS_FILE", "RESULTS_FILE", "SEAL", "Part",
    "parts_of",
]  # fmt: skip

MOST_REHEARSALS = 1_000  # of an episode
CURE = " Delete "  # with which the advice of an error begins
_STEM = re.compile(r"([0-9]{6,9})-([0-9]{6,9})")
MOST_SEEDS = 256  # of a part, whatever its name says; a task has at most 64
UNDECODABLE = (
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
        """Its measured values, sorted by seed. Raises CorruptPartError."""
        table = results.completed(self._table(RESULTS_FILE, results.RESULTS, results.LATER))
        try:
            results.require_possible(table)
        except ValueError as error:
            raise self._corrupt(self.path(RESULTS_FILE), str(error)) from error
        return table.take(pc.sort_indices(table, _by(table)))

    def episodes(self) -> Iterator[Episode]:
        """Its scored episodes, by seed. Raises CorruptPartError."""
        yield from self._episodes(EPISODES_FILE, len(self.seeds))

    def rehearsals(self) -> Iterator[Episode]:
        """The rehearsals of its episodes, by seed; none where none were made.

        Raises CorruptPartError.
        """
        if REHEARSALS_FILE in self._seal():
            yield from self._episodes(REHEARSALS_FILE, len(self.seeds) * MOST_REHEARSALS)

    def check(self) -> None:
        """Raise CorruptPartError where a file is missing or has another size than was sealed."""
        for suffix, sealed in self._seal().items():
            self._check_size(suffix, sealed)

    def _episodes(self, suffix: str, most: int) -> Iterator[Episode]:
        table = self._table(suffix, EPISODES, EPISODES_LATER)
        if len(table) > most:
            raise self._corrupt(self.path(suffix), f"has {len(table)} rows, more than {most}")
        order = pc.sort_indices(table, _by(table)).to_pylist()  # batches may be out of order
        try:
            yield from from_table(table, order)
        except UNDECODABLE as error:
            raise self._corrupt(self.path(suffix), f"cannot be decoded ({short(error)})") from error

    def _table(self, suffix: str, schema: pa.Schema, later: Collection[str]) -> pa.Table:
        """Return the table in one of its files; what is decoded are the bytes that were hashed."""
        path, sealed = self.path(suffix), self._seal()[suffix]
        self._check_size(suffix, sealed)
        try:
            content = path.read_bytes()
            found = hashlib.sha256(content).hexdigest()
            if found != sealed["sha256"]:
                raise self._corrupt(
                    path, f"has sha256 {found[:12]}…, sealed was {sealed['sha256'][:12]}…"
                )
            return bounded_parquet.read(content, schema, later)
        except ValueError as error:
            raise self._corrupt(path, short(error)) from error
        except OSError as error:
            raise self._corrupt(path, f"cannot be read ({short(error)})") from error

    def _seal(self) -> dict[str, Facts]:
        """Return size and sha256 of each of its files, as they were sealed."""
        seal = self.path(SEAL)
        try:
            return read_seal(bounded_json.read_text(seal, MOST_SEAL), len(self.seeds))
        except (OSError, ValueError) as error:
            raise self._corrupt(seal, f"cannot be read ({short(error)})") from error

    def _check_size(self, suffix: str, sealed: Facts) -> None:
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
            f"{CURE}{self.path(SEAL)} and run the same suite again with --out {run}"
            " to redo only this part."
        )


def _by(table: pa.Table) -> list[tuple[str, str]]:
    """By what the rows of a table of a part are sorted."""
    return [(key, "ascending") for key in ("seed", "rehearsal") if key in table.column_names]


def parts_of(folder: Path) -> list[Part]:
    """The sealed parts in the folder of one cell, by seed."""
    stems = (_STEM.fullmatch(seal.name.removesuffix(SEAL)) for seal in folder.glob(f"*{SEAL}"))
    found = sorted(Part(folder, int(stem[1]), int(stem[2])) for stem in stems if stem)
    return [part for part in found if 0 < len(part.seeds) <= MOST_SEEDS]
