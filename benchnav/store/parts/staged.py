"""Read the unsealed files that a worker wrote of a part, as untrusted input."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import pyarrow as pa

from benchnav.episode.episode import Episode, Identity
from benchnav.errors import CorruptPartError
from benchnav.store.bounded import bounded_parquet
from benchnav.store.parts.episodes import EPISODES, from_table
from benchnav.store.parts.part import EPISODES_FILE, REHEARSALS_FILE, UNDECODABLE, Part
from benchnav.store.parts.part_writer import temporary


def staged_episodes(part: Part, expected: Sequence[Identity]) -> Iterator[Episode]:
    """Yield the scored episodes, in the order of the file.

    ``expected`` lists them, in any order. Raises CorruptPartError if the file holds others,
    or cannot be read.
    """
    missing = set(expected)
    for episode in _episodes(part, EPISODES_FILE):
        if episode.identity not in missing:
            raise _corrupt(part, f"holds an unexpected episode: {episode.identity}")
        missing.discard(episode.identity)
        yield episode
    if missing:
        raise _corrupt(part, f"misses {len(missing)} of {len(expected)} episodes")


def check_rehearsals(part: Part, expected: Sequence[Identity], most: int) -> None:
    """Raise CorruptPartError for rehearsals of other episodes, or more than ``most`` of one."""
    earlier: set[Identity] = set()
    known = set(expected)
    if not temporary(part, REHEARSALS_FILE).exists():
        return
    for episode in _episodes(part, REHEARSALS_FILE):
        identity = episode.identity
        if (
            identity in earlier
            or not 0 < identity.rehearsal <= most
            or replace(identity, rehearsal=0) not in known
        ):
            raise _corrupt(part, f"holds an unexpected rehearsal: {identity}")


def _episodes(part: Part, suffix: str) -> Iterator[Episode]:
    try:
        content = temporary(part, suffix).read_bytes()
        table = bounded_parquet.read(content, EPISODES, ["perception"])
        yield from from_table(table, range(len(table)))
    except (OSError, pa.ArrowException, *UNDECODABLE) as error:
        raise _corrupt(part, f"cannot be read ({error})") from error


def _corrupt(part: Part, problem: Any) -> CorruptPartError:
    return CorruptPartError(f"{part.stem} is not a valid part of a worker. It {problem}.")
