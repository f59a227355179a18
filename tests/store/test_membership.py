"""Rows that are not of their part's cell are refused by every reader, before anything counts."""

import dataclasses

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchnav.errors import CorruptPartError, ForeignRowError
from benchnav.store.packs.pack import pack
from benchnav.store.parts.part import EPISODES_FILE, REHEARSALS_FILE, RESULTS_FILE, Part
from benchnav.store.parts.part_writer import PartWriter
from benchnav.store.runs.merge import merge
from benchnav.store.runs.pinned_run import changed_since, pinned, pinned_digest
from benchnav.store.runs.reading import read_episodes, read_rehearsals, read_results, results_of
from benchnav.store.runs.run_folder import RunFolder
from tests.conformance.refit import refit_seal

OWN = (
    "navigator", "scenario", "scenario_hash", "track", "split", "seed", "navigator_hash",
    "source_hash", "rehearsal",
)  # fmt: skip
READERS = {
    EPISODES_FILE: read_episodes,
    REHEARSALS_FILE: read_rehearsals,
    RESULTS_FILE: read_results,
}


@pytest.fixture
def folder(tools, run):
    """A run of one part of three seeds, with a rehearsal of each."""
    folder = RunFolder.start(run, tools.manifest(rehearsal=1))
    drawn = [tools.episode(np.random.default_rng(seed), seed, steps=2) for seed in range(3)]
    scored = [dataclasses.replace(e, rehearsals=1) for e in drawn]
    practice = [
        dataclasses.replace(e, identity=dataclasses.replace(e.identity, rehearsal=1)) for e in drawn
    ]
    with PartWriter(Part(folder.cell("cell"), 0, 3)) as writer:
        writer.add(scored, tools.results(scored), practice)
        writer.seal()
    return folder


def change(folder, suffix, column, value, row=1):
    """Let one row of a table say something else, under a seal that fits."""
    stem = str(folder.cell("cell") / "000000-000003")
    table = pq.read_table(stem + suffix)
    values = table[column].to_pylist()
    values[row] = value
    kind = table.schema.field(column).type
    place = table.column_names.index(column)
    pq.write_table(table.set_column(place, column, pa.array(values, kind)), stem + suffix)
    refit_seal(stem)


@pytest.mark.parametrize("suffix", READERS)
@pytest.mark.parametrize("column", OWN)
def test_a_row_of_another_cell_is_refused_by_file_and_row(folder, tmp_path, suffix, column):
    number = column in ("seed", "rehearsal")
    change(folder, suffix, column, 7 if number else "other")
    text = rf"{suffix} is damaged.* must have {column} .* in row 1.* it has '(7|other)'"
    with pytest.raises(ForeignRowError, match=text):
        list(READERS[suffix](folder.path))
    for refusing in (
        lambda: pack(RunFolder.open(folder.path), tmp_path / "x.bnrun"),
        lambda: merge([folder.path], tmp_path / "merged"),
    ):
        with pytest.raises(ForeignRowError, match=f"{column} .* in row 1"):
            refusing()
    assert not (tmp_path / "x.bnrun").exists()


@settings(max_examples=30)
@given(st.sampled_from(OWN[:5]), st.one_of(st.none(), st.text(max_size=200)))
def test_whatever_a_row_says(tmp_path_factory, column, value):
    from tests.store.conftest import make_episode, make_manifest, make_results

    folder = RunFolder.start(tmp_path_factory.mktemp("any") / "run", make_manifest())
    scored = [make_episode(np.random.default_rng(0), seed, steps=1) for seed in range(3)]
    with PartWriter(Part(folder.cell("cell"), 0, 3)) as writer:
        writer.add(scored, make_results(scored))
        writer.seal()
    if value != getattr(scored[0].identity, column):
        change(folder, RESULTS_FILE, column, value)
        with pytest.raises(ForeignRowError, match="in row 1"):
            read_results(folder.path)


def test_an_episode_that_stands_twice_and_one_that_is_missing(folder):
    change(folder, EPISODES_FILE, "seed", 0)
    with pytest.raises(ForeignRowError, match="each of its seeds once"):
        list(read_episodes(folder.path))


def test_a_column_that_tells_navigators_apart_must_be_there(folder):
    stem = str(folder.cell("cell") / "000000-000003")
    table = pq.read_table(stem + RESULTS_FILE).drop_columns(["navigator_hash"])
    pq.write_table(table, stem + RESULTS_FILE)
    refit_seal(stem)
    with pytest.raises(ForeignRowError, match="must have a column navigator_hash"):
        read_results(folder.path)


def test_a_manifest_that_does_not_say_of_what_its_rows_are(folder):
    suite = {**folder.manifest.suite, "navigators": []}
    RunFolder(folder.path, dataclasses.replace(folder.manifest, suite=suite)).kept()
    with pytest.raises(CorruptPartError, match="must identify the rows of a cell"):
        read_results(folder.path)


@pytest.mark.parametrize("back", [False, True])
def test_a_pinned_run_is_read_as_it_was_or_not_at_all(folder, back):
    """Also where the part is exchanged and put back: what is read is compared, not the disk."""
    held = pinned(folder)
    before, digest = results_of(held), pinned_digest(held)
    assert pinned_digest(pinned(folder)) == digest
    files = {path: path.read_bytes() for path in folder.cell("cell").iterdir()}
    change(folder, RESULTS_FILE, "value", 1.0)
    with pytest.raises(CorruptPartError, match="changed while the run was read"):
        results_of(held)
    assert len(changed_since(held)) == 2  # results and seal
    if back:
        for path, content in files.items():
            path.write_bytes(content)
        assert results_of(held) == before
        assert changed_since(held) == []


def test_a_part_that_comes_or_goes_after_pinning(folder, tools):
    held = pinned(folder)
    late = [tools.episode(np.random.default_rng(9), 3, steps=1)]
    with PartWriter(Part(folder.cell("cell"), 3, 4)) as writer:
        writer.add(late, tools.results(late))
        writer.seal()
    assert [part.first for part in held.parts()] == [0]
    assert changed_since(held)
    for path in folder.cell("cell").glob("000000-*"):
        path.unlink()
    with pytest.raises(CorruptPartError):
        results_of(held)
