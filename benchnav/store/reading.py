"""What readers of runs use: episodes and measured values of whole run folders."""

from collections.abc import Iterator
from pathlib import Path

import pyarrow as pa

from benchnav.episode.episode import Episode
from benchnav.store.results import RESULTS
from benchnav.store.run_folder import RunFolder


def read_episodes(run: Path) -> Iterator[Episode]:
    """Every scored episode of a run: cell by cell, by seed.

    Raises StoreError where the folder is no run, CorruptPartError for a damaged part.
    """
    for part in RunFolder.open(run).parts():
        yield from part.episodes()


def read_rehearsals(run: Path) -> Iterator[Episode]:
    """Every stored rehearsal of a run: cell by cell, by seed, in order.

    Raises as `read_episodes` does.
    """
    for part in RunFolder.open(run).parts():
        yield from part.rehearsals()


def read_results(run: Path) -> pa.Table:
    """The table of `RESULTS` of a run. Raises as `read_episodes` does."""
    parts = RunFolder.open(run).parts()
    return pa.concat_tables([RESULTS.empty_table(), *(part.results() for part in parts)])
