"""Read episodes and measured values of whole runs."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import pyarrow as pa

from benchnav.episode.episode import Episode
from benchnav.errors import CorruptPartError
from benchnav.scenario.condition import perception_of
from benchnav.store.bounded.bounded_parquet import allowed
from benchnav.store.parts.part import RESULTS_FILE, Part
from benchnav.store.parts.results import RESULTS
from benchnav.store.runs.manifest import Manifest
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.run_path import RunPath

_OF_A_CELL = ["scenario", "track", "perception", "navigator"]


def read_episodes(run: RunPath) -> Iterator[Episode]:
    """Yield every scored episode of a run: cell by cell, by seed; not the undisturbed ones.

    Raises UsageError if ``run`` is not a path, StoreError if the folder is not a run,
    CorruptPartError for a damaged part, or one that holds rows of another cell.
    """
    return episodes_of(RunFolder.open(run))


def episodes_of(run: RunFolder) -> Iterator[Episode]:
    """Yield the same, for an open run."""
    return (episode for part in _scored_parts(run) for episode in part.episodes())


def read_episodes_in_every_track(run: RunPath) -> Iterator[Episode]:
    """Yield the same, and repeat each episode for every other track that it represents.

    Raises like `read_episodes`.
    """
    return episodes_in_every_track(RunFolder.open(run))


def episodes_in_every_track(run: RunFolder) -> Iterator[Episode]:
    """Yield the same, for an open run."""
    cells = run.manifest.cells
    also = {_key_of(cell): cell.get("also", ()) for cell in cells}
    for episode in episodes_of(run):
        identity = episode.identity
        key = identity.scenario, identity.track, identity.perception, identity.navigator
        for track in (*also.get(key, ()), identity.track):
            yield replace(episode, identity=replace(identity, track=track))


def _key_of(cell: Mapping[str, Any]) -> tuple[str, str, str, str]:
    """Return the values of `_OF_A_CELL` of a cell of a manifest."""
    return cell["scenario"], cell["track"], perception_of(cell), cell["navigator"]


def read_rehearsals(run: RunPath) -> Iterator[Episode]:
    """Yield every stored rehearsal of a run: cell by cell, by seed, in order.

    Raises like `read_episodes`.
    """
    parts = RunFolder.open(run).parts()
    return (episode for part in parts for episode in part.rehearsals())


def read_results(run: RunPath) -> pa.Table:
    """Return the table of `RESULTS` of a run, in every track that an episode represents.

    Raises like `read_episodes`.
    """
    return results_of(RunFolder.open(run))


def results_of(run: RunFolder, *, undisturbed: bool = False) -> pa.Table:
    """Return the same, for an open run; with ``undisturbed``, also of undisturbed episodes."""
    parts = run.parts() if undisturbed else _scored_parts(run)
    joined = _joined(run, parts, Part.results, RESULTS.empty_table())
    return in_every_track(joined, run.manifest)


def encoded_results_of(run: RunFolder) -> pa.Table:
    """Return the same with texts as references to distinct texts: a third of the memory."""
    none = encoded(RESULTS.empty_table())
    joined = _joined(run, _scored_parts(run), Part.encoded_results, none)
    every = in_every_track(joined, run.manifest)
    return every.unify_dictionaries()  # else pyarrow cannot group by them


def encoded(results: pa.Table) -> pa.Table:
    """Return results (RESULTS) with texts as references to distinct texts."""
    for place, field in enumerate(results.schema):
        if pa.types.is_string(field.type):
            column = results[field.name].dictionary_encode()
            results = results.set_column(place, field.name, column)
    return results


def _scored_parts(run: RunFolder) -> Iterator[Part]:
    """Yield the parts of navigators."""
    for cell in run.manifest.cells:
        if not cell["reason"] and not run.manifest.is_undisturbed(cell):
            yield from run.parts_in(cell)


def _joined(
    run: RunFolder, parts: Iterable[Part], read: Callable[[Part], pa.Table], none: pa.Table
) -> pa.Table:
    """Return the tables of ``parts`` together, ``none`` if there are none."""
    tables = [none]
    decoded = stored = 0
    for part in parts:
        tables.append(read(part))
        decoded += tables[-1].nbytes
        stored += part.path(RESULTS_FILE).stat().st_size
        if decoded > allowed(stored):
            raise CorruptPartError(
                f"The results of {run.shown} must decode to at most {allowed(stored)} bytes, as"
                f" their files have {stored}. They decode to more."
            )
    return pa.concat_tables(tables)


def in_every_track(results: pa.Table, manifest: Manifest) -> pa.Table:
    """Return the rows of `RESULTS`, repeated for each other track that their cell represents.

    The rows may be encoded, like those of `encoded_results_of`.
    """
    others = [(*_key_of(cell), track) for cell in manifest.cells for track in cell.get("also", ())]
    if not others:
        return results
    columns = (pa.array(column, pa.string()) for column in zip(*others, strict=True))
    named = pa.table(dict(zip((*_OF_A_CELL, "other"), columns, strict=True)))
    cells = pa.schema([RESULTS.field(name) for name in _OF_A_CELL])
    rows = (
        results.select(_OF_A_CELL)
        .cast(cells)
        .append_column("row", pa.array(range(len(results)), pa.int64()))
    )
    found = rows.join(named, _OF_A_CELL, join_type="inner").sort_by("row")
    place = RESULTS.get_field_index("track")
    column = found["other"].cast(results.schema.field("track").type)
    again = results.take(found["row"]).set_column(place, "track", column)
    return pa.concat_tables([results, again])
