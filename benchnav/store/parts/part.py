"""A part: the episodes of one cell for a range of seeds, and the values measured on them.

A part is three files, or four if there were rehearsals. The seal is written last and
holds size and sha256 of the others; without a seal there is no part, even if a
killed run left other files.
"""

import hashlib
import re
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc

from benchnav.episode.episode import Episode
from benchnav.errors import CorruptPartError, ForeignRowError
from benchnav.navigation.command_check import short
from benchnav.store.bounded import bounded_json, bounded_parquet
from benchnav.store.parts import results
from benchnav.store.parts.episodes import EPISODES, from_table
from benchnav.store.parts.episodes import LATER as EPISODES_LATER
from benchnav.store.parts.membership import Membership
from benchnav.store.parts.seal import (
    EPISODES_FILE,
    FILES,
    MAX_SEAL,
    REHEARSALS_FILE,
    RESULTS_FILE,
    SEAL,
    Facts,
    read_seal,
)
from benchnav.store.runs.spans import SEED_DIGITS
from benchnav.system.plain_file import read_file

__all__ = [
    "EPISODES_FILE", "FILES", "MAX_SEEDS", "REHEARSALS_FILE", "RESULTS_FILE", "SEAL", "Part",
    "parts_of",
]  # fmt: skip

MAX_REHEARSALS = 1_000  # of an episode
CURE = " Delete "  # the beginning of an error's advice
_STEM = re.compile(rf"([0-9]{{6,{SEED_DIGITS}}})-([0-9]{{6,{SEED_DIGITS}}})")
MAX_SEEDS = 256  # of a part; a task has at most 64
UNDECODABLE = (
    KeyError, TypeError, ValueError, IndexError, AttributeError, OverflowError, RecursionError,
)  # fmt: skip


@dataclass(frozen=True, order=True)
class Part:
    """Seeds first … stop - 1 of the cell whose folder is ``folder``."""

    folder: Path
    first: int
    stop: int
    membership: Membership | None = field(default=None, compare=False, repr=False)
    # returns the undisturbed episode of a seed, see `UndisturbedEpisodes`; None: there are none
    undisturbed: Callable[[int], Episode | None] | None = field(
        default=None, compare=False, repr=False
    )

    @property
    def stem(self) -> str:
        """The common start of its file names."""
        return f"{self.first:06d}-{self.stop:06d}"

    def path(self, suffix: str) -> Path:
        """Return the path of one of its files."""
        return self.folder / f"{self.stem}{suffix}"

    @property
    def seeds(self) -> range:
        """The seeds in it."""
        return range(self.first, self.stop)

    @property
    def sealed(self) -> bool:
        """Whether it is complete on disk."""
        return self.path(SEAL).exists()

    def results(self) -> pa.Table:
        """Return its measured values, sorted by seed. Raises CorruptPartError."""
        return self.encoded_results().cast(results.RESULTS)

    def encoded_results(self) -> pa.Table:
        """Return the same with texts as references to distinct texts: a third of the memory."""
        stored = self._table(RESULTS_FILE, results.RESULTS, results.LATER, encoded=True)
        table = results.completed(stored)
        try:
            results.require_possible(table)
        except ValueError as error:
            raise self._corrupt(self.path(RESULTS_FILE), str(error)) from error
        return table if _is_sorted(table) else table.take(pc.sort_indices(table, _by(table)))

    def episodes(self) -> Iterator[Episode]:
        """Yield its scored episodes, by seed. Raises CorruptPartError."""
        for episode in self._episodes(EPISODES_FILE, len(self.seeds)):
            if self.undisturbed is not None:
                other = partial(self.undisturbed, episode.identity.seed)
                episode = replace(episode, undisturbed=other)
            yield episode

    def steps(self) -> dict[int, int]:
        """Return the number of decisions of each scored episode, by seed. Raises CorruptPartError.

        No episode is decoded for it.
        """
        table = self._table(EPISODES_FILE, EPISODES, EPISODES_LATER)
        return dict(zip(table["seed"].to_pylist(), table["steps"].to_pylist(), strict=True))

    def rehearsals(self) -> Iterator[Episode]:
        """Yield the rehearsals of its episodes, by seed.

        Raises CorruptPartError.
        """
        if REHEARSALS_FILE in self._seal():
            yield from self._episodes(REHEARSALS_FILE, len(self.seeds) * MAX_REHEARSALS)

    def check(self) -> None:
        """Raise CorruptPartError if a file is missing or differs from its sealed size."""
        for suffix, sealed in self._seal().items():
            self._check_size(suffix, sealed)

    def check_rows(self) -> None:
        """Raise CorruptPartError if a file differs from its seal, or a row is not of the part."""
        self.results()
        for suffix in (EPISODES_FILE, REHEARSALS_FILE):
            if suffix in self._seal():
                self._table(suffix, EPISODES, EPISODES_LATER)

    def _episodes(self, suffix: str, most: int) -> Iterator[Episode]:
        table = self._table(suffix, EPISODES, EPISODES_LATER)
        if len(table) > most:
            raise self._corrupt(self.path(suffix), f"has {len(table)} rows, more than {most}")
        order = pc.sort_indices(table, _by(table)).to_pylist()  # batches may be out of order
        try:
            yield from from_table(table, order)
        except UNDECODABLE as error:
            raise self._corrupt(self.path(suffix), f"cannot be decoded ({short(error)})") from error

    def _table(
        self, suffix: str, schema: pa.Schema, later: Collection[str], encoded: bool = False
    ) -> pa.Table:
        """Return the table in one of its files; the decoded bytes are the hashed bytes."""
        path, sealed = self.path(suffix), self._seal()[suffix]
        self._check_size(suffix, sealed)
        try:
            content = read_file(path, sealed["bytes"])
            found = hashlib.sha256(content).hexdigest()
            if found != sealed["sha256"]:
                raise self._corrupt(
                    path, f"has sha256 {found[:12]}…; its seal has {sealed['sha256'][:12]}…"
                )
            table = bounded_parquet.read(content, schema, later, encoded)
        except ValueError as error:
            raise self._corrupt(path, short(error)) from error
        except OSError as error:
            raise self._corrupt(path, f"cannot be read ({short(error)})") from error
        self._refuse_foreign(suffix, table)
        return table

    def _refuse_foreign(self, suffix: str, table: pa.Table) -> None:
        """Raise CorruptPartError if a row is of another cell, or of a seed outside this part."""
        if self.membership is None:
            return
        try:
            self.membership.require_rows(table, self.seeds, scored=suffix != REHEARSALS_FILE)
        except ValueError as error:
            raise ForeignRowError(str(self._corrupt(self.path(suffix), str(error)))) from error

    def _seal(self) -> dict[str, Facts]:
        """Return size and sha256 of each of its files, from the seal."""
        seal = self.path(SEAL)
        try:
            text = bounded_json.read_text(seal, MAX_SEAL)
            self._refuse_another_seal(text)
            return read_seal(text, len(self.seeds))
        except (OSError, ValueError) as error:
            raise self._corrupt(seal, f"cannot be read ({short(error)})") from error

    def _refuse_another_seal(self, text: str) -> None:
        """Raise ValueError if the part was replaced after its run was pinned."""
        pinned = self.membership.seals if self.membership else {}
        if pinned and pinned.get(self.path(SEAL).name) != hashlib.sha256(text.encode()).hexdigest():
            raise ValueError("it was changed while the run was read")

    def _check_size(self, suffix: str, sealed: Facts) -> None:
        path = self.path(suffix)
        if not path.exists():
            raise self._corrupt(path, "is missing")
        if path.stat().st_size != sealed["bytes"]:
            raise self._corrupt(
                path, f"has {path.stat().st_size} bytes; its seal has {sealed['bytes']}"
            )

    def _corrupt(self, path: Path, problem: str) -> CorruptPartError:
        run = self.folder.parent.parent
        return CorruptPartError(
            f"{path} is damaged. It {problem}."
            f"{CURE}{self.path(SEAL)} and run the same suite again into {run}"
            " to redo only this part."
        )


def _by(table: pa.Table) -> list[tuple[str, str]]:
    """Return the sort keys of a part's table."""
    return [(key, "ascending") for key in ("seed", "rehearsal") if key in table.column_names]


def _is_sorted(table: pa.Table) -> bool:
    """Whether the rows of a table of one number of rehearsals are sorted by seed already."""
    seeds, rehearsals = table["seed"].to_numpy(), table["rehearsal"].unique()
    return len(rehearsals) == 1 and bool((seeds[1:] >= seeds[:-1]).all())


def parts_of(folder: Path) -> list[Part]:
    """Return the sealed parts in the folder of one cell, by seed."""
    return named_parts(folder, (seal.name for seal in folder.glob(f"*{SEAL}")))


def named_parts(folder: Path, seals: Iterable[str]) -> list[Part]:
    """Return the parts with these seals, by seed."""
    stems = (_STEM.fullmatch(name.removesuffix(SEAL)) for name in seals)
    found = sorted(Part(folder, int(stem[1]), int(stem[2])) for stem in stems if stem)
    return [part for part in found if 0 < len(part.seeds) <= MAX_SEEDS]
