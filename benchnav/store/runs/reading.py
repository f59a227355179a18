"""What readers of runs use: episodes and measured values of whole run folders."""

from collections.abc import Iterator
from dataclasses import replace

import pyarrow as pa

from benchnav.episode.episode import Episode
from benchnav.errors import CorruptPartError
from benchnav.store.bounded.bounded_parquet import allowed
from benchnav.store.parts.part import RESULTS_FILE
from benchnav.store.parts.results import RESULTS
from benchnav.store.runs.manifest import Manifest
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.run_path import RunPath

_OF_A_CELL = ["scenario", "track", "navigator"]


def read_episodes(run: RunPath) -> Iterator[Episode]:
    """Every scored episode of a run: cell by cell, by seed.

    Raises UsageError where ``run`` is no path, StoreError where the folder is no run,
    CorruptPartError for a damaged part, or one that holds rows of another cell.
    """
    return episodes_of(RunFolder.open(run))


def episodes_of(run: RunFolder) -> Iterator[Episode]:
    """The same, of a run that is open already."""
    return (episode for part in run.parts() for episode in part.episodes())


def read_episodes_in_every_track(run: RunPath) -> Iterator[Episode]:
    """The same, each once more for every other track that it stands for.

    Raises as `read_episodes` does.
    """
    return episodes_in_every_track(RunFolder.open(run))


def episodes_in_every_track(run: RunFolder) -> Iterator[Episode]:
    """The same, of a run that is open already."""
    cells = run.manifest.cells
    also = {(c["scenario"], c["track"], c["navigator"]): c.get("also", ()) for c in cells}
    for episode in episodes_of(run):
        said = episode.identity
        for track in (*also.get((said.scenario, said.track, said.navigator), ()), said.track):
            yield replace(episode, identity=replace(said, track=track))


def read_rehearsals(run: RunPath) -> Iterator[Episode]:
    """Every stored rehearsal of a run: cell by cell, by seed, in order.

    Raises as `read_episodes` does.
    """
    parts = RunFolder.open(run).parts()
    return (episode for part in parts for episode in part.rehearsals())


def read_results(run: RunPath) -> pa.Table:
    """The table of `RESULTS` of a run, in every track that an episode stands for.

    Raises as `read_episodes` does.
    """
    return results_of(RunFolder.open(run))


def results_of(run: RunFolder) -> pa.Table:
    """The same, of a run that is open already."""
    tables = [RESULTS.empty_table()]
    decoded = stored = 0
    for part in run.parts():
        tables.append(part.results())
        decoded += tables[-1].nbytes
        stored += part.path(RESULTS_FILE).stat().st_size
        if decoded > allowed(stored):
            raise CorruptPartError(
                f"The results of {run.shown} must decode to at most {allowed(stored)} bytes, as"
                f" their files have {stored}. They decode to more."
            )
    return in_every_track(pa.concat_tables(tables), run.manifest)


def in_every_track(results: pa.Table, manifest: Manifest) -> pa.Table:
    """The rows of `RESULTS`, and once more for each other track that their cell stands for."""
    others = [
        (*(cell[name] for name in _OF_A_CELL), track)
        for cell in manifest.cells
        for track in cell.get("also", ())
    ]
    if not others:
        return results
    columns = (pa.array(column, pa.string()) for column in zip(*others, strict=True))
    named = pa.table(dict(zip((*_OF_A_CELL, "other"), columns, strict=True)))
    rows = results.select(_OF_A_CELL).append_column(
        "row", pa.array(range(len(results)), pa.int64())
    )
    found = rows.join(named, _OF_A_CELL, join_type="inner").sort_by("row")
    place = RESULTS.get_field_index("track")
    again = results.take(found["row"]).set_column(place, RESULTS.field("track"), found["other"])
    return pa.concat_tables([results, again])
