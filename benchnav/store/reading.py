"""What readers of runs use: episodes and measured values of whole run folders."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc

from benchnav.episode.episode import Episode
from benchnav.store.manifest import Manifest
from benchnav.store.results import RESULTS
from benchnav.store.run_folder import RunFolder


def read_episodes(run: Path) -> Iterator[Episode]:
    """Every scored episode of a run: cell by cell, by seed.

    Raises StoreError where the folder is no run, CorruptPartError for a damaged part.
    """
    for part in RunFolder.open(run).parts():
        yield from part.episodes()


def read_episodes_in_every_track(run: Path) -> Iterator[Episode]:
    """The same, each once more for every other track that it stands for.

    Raises as `read_episodes` does.
    """
    cells = RunFolder.open(run).manifest.cells
    also = {(c["scenario"], c["track"], c["navigator"]): c.get("also", ()) for c in cells}
    for episode in read_episodes(run):
        said = episode.identity
        for track in (*also.get((said.scenario, said.track, said.navigator), ()), said.track):
            yield replace(episode, identity=replace(said, track=track))


def read_rehearsals(run: Path) -> Iterator[Episode]:
    """Every stored rehearsal of a run: cell by cell, by seed, in order.

    Raises as `read_episodes` does.
    """
    for part in RunFolder.open(run).parts():
        yield from part.rehearsals()


def read_results(run: Path) -> pa.Table:
    """The table of `RESULTS` of a run, in every track that an episode stands for.

    Raises as `read_episodes` does.
    """
    folder = RunFolder.open(run)
    tables = [part.results() for part in folder.parts()]
    return in_every_track(pa.concat_tables([RESULTS.empty_table(), *tables]), folder.manifest)


def in_every_track(results: pa.Table, manifest: Manifest) -> pa.Table:
    """The rows of `RESULTS`, and once more for each other track that their cell stands for."""
    found = [results]
    for cell in manifest.cells:
        for track in cell.get("also", ()):
            of_cell = pc.and_(
                pc.equal(results["scenario"], cell["scenario"]),
                pc.and_(
                    pc.equal(results["track"], cell["track"]),
                    pc.equal(results["navigator"], cell["navigator"]),
                ),
            )
            rows = results.filter(of_cell)
            place = RESULTS.get_field_index("track")
            tracks = pa.repeat(pa.scalar(track, pa.string()), len(rows))
            found.append(rows.set_column(place, RESULTS.field("track"), tracks))
    return pa.concat_tables(found)
