"""What reading takes is known before it is done: sizes are taken from where they bind."""

import io
import json
import subprocess
import sys
import time
from zipfile import ZIP_STORED, ZipFile

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from benchnav.errors import CorruptPartError, StoreError
from benchnav.store.bounded import bounded_json, bounded_parquet
from benchnav.store.bounded.footer import require_readable
from benchnav.store.packs.unpack import opened
from benchnav.store.parts.part import RESULTS_FILE, SEAL, Part
from benchnav.store.parts.part_writer import PartWriter
from benchnav.store.parts.results import RESULTS
from benchnav.store.parts.seal import read_seal
from benchnav.store.runs import checked_json
from benchnav.store.runs.manifest import MANIFEST, load_manifest
from benchnav.store.runs.reading import (
    encoded,
    encoded_results_of,
    in_every_track,
    read_results,
)
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.spans import count, twice, union, without
from tests.store import changed_footers
from tests.store.hostile import resealed

SCHEMA = pa.schema([("n", pa.int64()), ("text", pa.string()), ("list", pa.list_(pa.string()))])


def written(table, **options):
    out = io.BytesIO()
    pq.write_table(table, out, compression="zstd", **options)
    return out.getvalue()


def table_of(rows, text="a"):
    return pa.table({"n": [1] * rows, "text": [text] * rows, "list": [[text]] * rows}, SCHEMA)


def test_lists_in_lists_are_refused_before_they_are_too_deep():
    lists = bytes([0x49]) + bytes([0x19]) * 100_000  # field 4; each list holds one list
    content = lists + len(lists).to_bytes(4, "little") + b"PAR1"
    with pytest.raises(ValueError, match="nested too deep"):
        require_readable(content, None)


@pytest.mark.parametrize(
    "changes",
    [(1, 2, 4, 16, 255), pytest.param(range(1, 256), marks=[pytest.mark.soak, pytest.mark.slow])],
)
def test_a_changed_footer_is_refused_and_never_ends_the_process(changes):
    done = subprocess.run(
        [sys.executable, changed_footers.__file__, *map(str, changes)],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-2000:]
    assert int(done.stdout) > 500 * len(changes)


@pytest.mark.parametrize(
    "options", [{}, {"use_dictionary": False}, {"row_group_size": 7}, {"data_page_version": "2.0"}]
)
def test_what_our_writer_writes_is_read(options):
    table = table_of(100)
    assert bounded_parquet.read(written(table, **options), SCHEMA).equals(table)
    fewer = table.drop_columns(["list"])
    assert bounded_parquet.read(written(fewer, **options), SCHEMA, ["list"]).equals(fewer)


def dictionary_of(size, rows):
    long = pa.DictionaryArray.from_arrays(pa.array([0] * rows, pa.int32()), pa.array(["x" * size]))
    table = pa.table({"n": [1] * rows, "text": long, "list": [["a"]] * rows})
    return written(table, dictionary_pagesize_limit=1 << 30, store_schema=False)


def list_of(rows, items):
    lists = pa.ListArray.from_arrays(
        np.arange(rows + 1, dtype=np.int32) * items, pa.nulls(rows * items, pa.string())
    )
    return written(pa.table({"n": [1] * rows, "text": ["a"] * rows, "list": lists}, SCHEMA))


@pytest.mark.parametrize(
    "content",
    [
        dictionary_of(1 << 20, 2000),
        list_of(1, 50_000_000),
        written(table_of(1).take(pa.array([0] * 20_000_000)).select(["n", "text", "list"])),
        written(table_of(50, "x" * (1 << 20)), column_encoding={"text": "DELTA_BYTE_ARRAY",
                "list.list.element": "PLAIN", "n": "PLAIN"}, use_dictionary=False),
    ],
    ids=["dictionary", "nulls in a list", "rows", "front coding"],
)  # fmt: skip
def test_small_files_that_decode_to_gigabytes_are_refused(content):
    assert len(content) < 4 << 20
    before = pa.default_memory_pool().max_memory()
    with pytest.raises(ValueError, match=r"holds|encoding"):
        bounded_parquet.read(content, SCHEMA)
    assert pa.default_memory_pool().max_memory() - before < bounded_parquet.allowed(len(content))


def test_a_page_that_hides_its_size_is_refused():
    """The decoder takes field 2 + 2**16 for field 2: who does not is told another size."""
    from benchnav.store.bounded.page_headers import pages

    honest = bytes.fromhex("1500151015102c15021500150615060000") + b"x" * 8
    assert next(pages(memoryview(honest))).raw == 8
    hidden = honest[:6] + bytes([0x05]) + b"\x84\x80\x08" + b"\xfe\xff\xff\xff\x0f" + honest[6:]
    with pytest.raises(ValueError, match="header of a page"):
        list(pages(memoryview(hidden)))


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (lambda t: t.drop_columns(["n"]), "must have the column 'n'"),
        (lambda t: t.append_column("m", t["n"]), "unknown column 'm'"),
        (lambda t: t.set_column(0, "n", pa.array(["a"] * len(t))), "'n' of int64; it is of string"),
        (lambda t: t.select(["text", "n", "list"]), "in another order"),
    ],
)
def test_other_columns_are_refused(change, complaint):
    with pytest.raises(ValueError, match=complaint):
        bounded_parquet.read(written(change(table_of(3))), SCHEMA)


@pytest.fixture
def part(tools, run):
    folder = RunFolder.start(run, tools.manifest())
    episodes = [tools.episode(np.random.default_rng(0), seed) for seed in range(3)]
    made = Part(folder.cell("cell"), 0, 3)
    with PartWriter(made) as writer:
        writer.add(episodes, tools.results(episodes))
        writer.seal()
    return made


def put(part, change):
    """Results that were changed and sealed again."""
    table = change(pq.read_table(part.path(RESULTS_FILE), partitioning=None))
    pq.write_table(table, part.path(RESULTS_FILE), compression="zstd")
    files = {p.name: p.read_bytes() for p in part.folder.iterdir()}
    part.path(SEAL).write_bytes(resealed(files)[part.path(SEAL).name])


@pytest.mark.parametrize(
    ("name", "value"),
    [("value", float("inf")), ("value", -1e308), ("value", None), ("seed", 2**63 - 1), ("seed", -1),
     ("seed", 0), ("seed", None), ("role", "boss"), ("track", None), ("track", "all"),
     ("split", "x"), ("horizon", float("nan")), ("dt", None), ("agents", -1), ("agents", 0),
     ("defined", 2**62), ("defined", 3), ("failure", None), ("rehearsal", -1), ("missing", None),
     ("missing", "x" * 1_000_000), ("metric", None), ("metric", "x" * 300), ("navigator", None),
     ("navigator", "x" * 300), ("remarks", ["x" * 1_000_000]), ("navigator_hash", "x" * 100)],
)  # fmt: skip
def test_results_that_cannot_be_are_refused_in_a_sentence(part, name, value):
    kind = RESULTS.field(name).type

    def changed(table):
        column = pa.array([value] * len(table), kind)
        return table.set_column(RESULTS.get_field_index(name), RESULTS.field(name), column)

    put(part, lambda table: table)
    part.results()
    put(part, changed)
    with pytest.raises(CorruptPartError) as refused:
        part.results()
    assert str(part.path(RESULTS_FILE)) in str(refused.value)
    assert name in str(refused.value)
    assert len(str(refused.value)) < 1000


def test_results_may_be_undefined(part):
    nothing = pa.array([float("nan")] * 3)
    put(part, lambda t: t.set_column(8, RESULTS.field("value"), nothing))
    assert np.isnan(part.results()["value"].to_numpy()).all()


@pytest.mark.parametrize(
    "text",
    ["[" * 100_000, '{"a":' * 5_000 + "1" + "}" * 5_000, "[" * 500 + "]" * 500, "", "\ufeff{}",
     '{"a": 1, "a": 2}', '{"a": "\\ud800"}', "[" + "[]," * 1_100_000 + "[]]", "9" * 5000, "{",
     "nul"],
)  # fmt: skip
def test_hostile_json_is_a_value_error(text):
    with pytest.raises(ValueError, match=r"."):
        bounded_json.load(text)


def test_files_of_json_are_bounded(tmp_path):
    (tmp_path / "x").write_bytes(b" " * 1001)
    with pytest.raises(ValueError, match="at most 1000 bytes"):
        bounded_json.read_text(tmp_path / "x", 1000)
    (tmp_path / "x").write_bytes(b"\xff")
    with pytest.raises(ValueError, match="decode"):
        bounded_json.read_text(tmp_path / "x", 1000)


GOOD = {"bytes": 1, "sha256": "0" * 64}


@pytest.mark.parametrize(
    ("fields", "complaint"),
    [
        ({".episodes.parquet": GOOD, "episodes": 1}, "must have the key '.results.parquet'"),
        ({".episodes.parquet": {"bytes": 1}}, "bytes and sha256"),
        ({".episodes.parquet": {**GOOD, "bytes": True}}, "must be a size"),
        ({".episodes.parquet": {**GOOD, "sha256": "x"}}, "64 digits"),
        ({"episodes": True}, "is of True episodes"), ({"x": 1}, "unknown key 'x'"),
    ],
)  # fmt: skip
def test_seals_are_checked(fields, complaint):
    whole = {".episodes.parquet": GOOD, ".results.parquet": GOOD, "episodes": 1}
    given = fields if "must have the key" in complaint else {**whole, **fields}
    with pytest.raises(ValueError, match=complaint):
        read_seal(checked_json.dump(given), 1)


@pytest.mark.parametrize(
    ("key", "value"),
    [("seeds", [0, 10**12]), ("seeds", "ab"), ("seeds", [5, 5]), ("seeds", None), ("name", 5),
     ("navigators", 5), ("navigators", [{}]), ("scenarios", [5]), ("tracks", ["all"]), ("x", 1),
     ("version", 3.5), ("split", ["test"])],
)  # fmt: skip
def test_suites_that_cannot_be_are_refused_with_key_and_value(tools, run, key, value):
    RunFolder.start(run, tools.manifest())
    suite = tools.manifest(**{key: value})
    (run / MANIFEST).write_text(suite.dump())
    with pytest.raises(CorruptPartError, match=rf"manifest\.json is damaged.* suite\.{key}"):
        load_manifest(run)


@pytest.mark.parametrize(
    ("key", "value"),
    [("also", 5), ("also", ["known"] * 20_000), ("seeds", [[0, 10**15]]), ("seeds", [[3, 1]]),
     ("seeds", [[0, 5], [4, 6]]), ("track", 5), ("reason", None), ("navigator", "x" * 300)],
)  # fmt: skip
def test_cells_that_cannot_be_are_refused_with_key(tools, run, key, value):
    manifest = RunFolder.start(run, tools.manifest()).manifest
    fields = json.loads(manifest.dump())
    del fields["sha256"]
    fields["cells"][0][key] = value
    (run / MANIFEST).write_text(checked_json.dump(fields))
    with pytest.raises(CorruptPartError, match=rf"cells\[0\]\.{key}"):
        load_manifest(run)


def test_older_manifests_and_labels_that_ran_unguarded_are_read(tools, run):
    fields = json.loads(RunFolder.start(run, tools.manifest()).manifest.dump())
    del fields["sha256"]
    (run / MANIFEST).write_text(checked_json.dump({**fields, "unguarded": ["orca"]}))
    load_manifest(run)
    for key in ("salt", "limits", "shard", "sources"):
        del fields[key]
    (run / MANIFEST).write_text(json.dumps({**fields, "schema": 1}))
    assert load_manifest(run).schema == 1


def test_a_member_twice_among_many_is_found_in_time_that_grows_with_their_number(tmp_path):
    path = tmp_path / "many.bnrun"
    names = [f"files/{k:064x}" for k in range(30_000)]
    with ZipFile(path, "w", ZIP_STORED) as archive:
        archive.writestr("index.json", '{"format": 1, "files": {}}')
        for name in names:
            archive.writestr(name, b"")
        with pytest.warns(UserWarning, match="Duplicate"):
            archive.writestr(names[-1], b"")
    began = time.process_time()
    with pytest.raises(StoreError, match="twice"), opened(path):
        pass
    assert time.process_time() - began < 5  # 10 s where each is compared with each


def test_spans_are_not_expanded():
    far = [(0, 10**12)]
    assert without(far, [(5, 7), (6, 10), (10**11, 10**13)]) == [(0, 5), (10, 10**11)]
    assert without([(0, 3), (5, 8)], []) == [(0, 3), (5, 8)]
    assert twice([(0, 10), (2, 4), (3, 12), (20, 30)]) == [(2, 10)]
    assert union([(0, 4), (2, 6), (6, 7), (9, 10)]) == [(0, 7), (9, 10)]
    assert count(far) == 10**12


def test_rows_stand_for_other_tracks_in_one_pass(part, run):
    results = read_results(run)
    manifest = load_manifest(run)
    cells = tuple({**cell, "also": ["stale", "unknown"]} for cell in manifest.cells)
    object.__setattr__(manifest, "cells", cells)
    found = in_every_track(results, manifest)
    assert found.schema == results.schema
    assert sorted(found["track"].to_pylist()) == ["known"] * 3 + ["stale"] * 3 + ["unknown"] * 3
    assert in_every_track(encoded(results), manifest).cast(RESULTS).equals(found)


def test_encoded_results_are_the_results_in_less_memory(part, run):
    found = encoded_results_of(RunFolder.open(run))
    assert found.cast(RESULTS).equals(read_results(run))
    assert found.nbytes < read_results(run).nbytes


@pytest.mark.parametrize("texts", [["a", "b"], ["a", "a"]])
def test_texts_that_stay_references_are_distinct(texts):
    column = pa.DictionaryArray.from_arrays(pa.array([0, 1], pa.int32()), pa.array(texts))
    table = pa.table({"n": [1, 2], "text": column, "list": [["a"], ["b"]]})
    content = written(table, store_schema=False)
    try:
        found = bounded_parquet.read(content, SCHEMA, encoded=True)
    except ValueError as error:
        assert "repeats a text" in str(error)  # noqa: PT017 - writers may also repair it
    else:
        assert pa.types.is_dictionary(found["text"].type)
        assert found["text"].unique().to_pylist() == list(dict.fromkeys(texts))
        assert found.cast(SCHEMA).equals(bounded_parquet.read(content, SCHEMA))
