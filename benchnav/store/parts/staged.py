"""What a worker wrote of a part and nobody sealed yet: read as what a stranger wrote."""

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
    """The scored episodes, in the order in which they were written.

    ``expected`` says which, in any order. Raises CorruptPartError where the file holds others,
    or cannot be read.
    """
    missing = set(expected)
    for episode in _episodes(part, EPISODES_FILE):
        if episode.identity not in missing:
            raise _strange(part, f"holds an episode that is not to be there: {episode.identity}")
        missing.discard(episode.identity)
        yield episode
    if missing:
        raise _strange(part, f"lacks {len(missing)} of {len(expected)} episodes")


def check_rehearsals(part: Part, expected: Sequence[Identity], most: int) -> None:
    """Raise CorruptPartError for rehearsals of other episodes, or more than ``most`` of one."""
    seen: set[Identity] = set()
    known = set(expected)
    if not temporary(part, REHEARSALS_FILE).exists():
        return
    for episode in _episodes(part, REHEARSALS_FILE):
        said = episode.identity
        if (
            said in seen
            or not 0 < said.rehearsal <= most
            or replace(said, rehearsal=0) not in known
        ):
            raise _strange(part, f"holds a rehearsal that is not to be there: {said}")
        seen.add(said)


def _episodes(part: Part, suffix: str) -> Iterator[Episode]:
    try:
        table = bounded_parquet.read(temporary(part, suffix).read_bytes(), EPISODES)
        yield from from_table(table, range(len(table)))
    except (OSError, pa.ArrowException, *UNDECODABLE) as error:
        raise _strange(part, f"cannot be read ({error})") from error


def _strange(part: Part, what: Any) -> CorruptPartError:
    return CorruptPartError(f"{part.stem} must be what a worker writes. It {what}.")
