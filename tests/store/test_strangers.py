"""What a stranger wrote is data: it leads nowhere, and what was changed is named."""

import dataclasses
import json

import numpy as np
import pyarrow.parquet as pq
import pytest

from benchnav.errors import CorruptPartError
from benchnav.store.bounded import bounded_parquet
from benchnav.store.parts.episodes import from_table
from benchnav.store.parts.part import EPISODES_FILE, Part
from benchnav.store.parts.part_writer import PartWriter
from benchnav.store.parts.world_codec import from_json, world_from_json, world_to_json
from benchnav.store.runs.manifest import MANIFEST, load_manifest
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.scenario_files import FOLDER, UP, keep_files, sha256_of, stage_files


@pytest.fixture
def kept(tmp_path):
    """A run that keeps two files, and the names that a scenario has for them."""
    sources = {"maps/a.map": b"one", "../b.map": b"two"}
    for name, content in sources.items():
        path = tmp_path / "made" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    run = tmp_path / "run"
    run.mkdir()
    keep_files(run, {name: tmp_path / "made" / name for name in sources})
    return run, {name: sha256_of(tmp_path / "made" / name) for name in sources}


def test_files_of_a_scenario_are_found_again_under_their_names(kept, tmp_path):
    run, files = kept
    folder = stage_files(run, files, tmp_path / "stage")
    assert (folder / "maps/a.map").read_bytes() == b"one"
    assert (folder / "../b.map").read_bytes() == b"two"
    assert sorted(path.name for path in (run / FOLDER).iterdir()) == sorted(files.values())


@pytest.mark.parametrize(
    "name", ["/etc/passwd", "../" * (UP + 1) + "x", "a\\b", "c:x", "", ".", "../" * UP]
)
def test_no_name_leads_out(kept, tmp_path, name):
    run, files = kept
    before = set(tmp_path.rglob("*"))
    with pytest.raises(CorruptPartError, match="named relative to the scenario's own"):
        stage_files(run, {name: next(iter(files.values()))}, tmp_path / "stage")
    new = set(tmp_path.rglob("*")) - before
    assert all(path.is_relative_to(tmp_path / "stage") for path in new)


@pytest.mark.parametrize("sha", ["0" * 64, "../manifest.json", ""])
def test_a_file_that_lacks_is_named(kept, tmp_path, sha):
    with pytest.raises(CorruptPartError, match=r"must hold the file 'a\.map'"):
        stage_files(kept[0], {"a.map": sha}, tmp_path / "stage")


def test_a_file_that_was_changed_is_refused(kept, tmp_path):
    run, files = kept
    (run / FOLDER / files["maps/a.map"]).write_bytes(b"uno")
    with pytest.raises(CorruptPartError, match="It was changed"):
        stage_files(run, files, tmp_path / "stage")


@pytest.mark.parametrize("key", ["../../secret", "/etc", ".hidden", "", "a/b", 7])
def test_a_cell_is_called_like_a_folder(tools, run, key):
    folder = RunFolder.start(run, tools.manifest())
    cells = ({**folder.manifest.cells[0], "key": key},)
    text = dataclasses.replace(folder.manifest, cells=cells).dump()
    (run / MANIFEST).write_text(text)
    with pytest.raises(CorruptPartError, match=r"cells\[0\]\.key must"):
        load_manifest(run)


@pytest.mark.parametrize("name", ["salt", "versions", "platform", "created", "cells"])
def test_a_changed_manifest_is_refused(tools, run, name):
    RunFolder.start(run, tools.manifest())
    said = json.loads((run / MANIFEST).read_text())
    said[name] = [] if name == "cells" else {} if name == "versions" else "x"
    (run / MANIFEST).write_text(json.dumps(said))
    with pytest.raises(CorruptPartError, match="is damaged"):
        load_manifest(run)


def test_deeply_nested_json_is_refused(run):
    run.mkdir()
    (run / MANIFEST).write_text("[" * 100_000)
    with pytest.raises(CorruptPartError, match="cannot be read"):
        load_manifest(run)


def test_arrays_are_of_plain_numbers(tools):
    text = world_to_json(tools.world(np.random.default_rng(0))).decode()
    for dtype in ("|O", "|V999999999", "|S9", 3):
        changed = text.replace('"<f8"', json.dumps(dtype), 1)
        with pytest.raises(ValueError, match=r"must be an array .* of <f8"):
            world_from_json(changed)
    assert from_json(bool, "true") is True


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"dt":', '"dx":', r"^clock\.dt must be given; got"),
        (
            '"substeps":',
            '"substeps":"x","y":',
            r"^clock\.substeps must be a whole number; got 'x'$",
        ),
        ('"radius":0.0', '"radius":"0"', r"^solids\.0\.radius must be a number; got '0'$"),
        ('"kind":2', '"kind":33', r"^solids\.0\.kind must be 0, 1, 2, 3, 4 or 5; got 33$"),
        ('"teams":["', '"teams":[7,"', r"^teams\.0 must be text; got 7$"),
        ('"teams":["', '"teams":["\\ud800', r"^its text must be JSON: .+; got"),
        ('"clock":{', '"clock":' + "[" * 100_000, r"^its text must be JSON: .+; got"),
    ],
)
def test_a_broken_world_is_named_in_few_words(tools, old, new, message):
    text = world_to_json(tools.world(np.random.default_rng(0))).decode()
    assert old in text
    with pytest.raises(ValueError, match=message) as raised:
        world_from_json(text.replace(old, new, 1))
    assert len(str(raised.value)) < 500


def test_many_strange_values_are_one_error():
    with pytest.raises(ValueError, match=r"^0 must be a whole number; got None$"):
        from_json(tuple[int, ...], json.dumps([None] * 1_000_000))


def test_a_small_file_that_would_fill_memory_is_refused(tools, run, monkeypatch):
    folder = RunFolder.start(run, tools.manifest())
    episodes = [tools.episode(np.random.default_rng(0), 0)]
    with PartWriter(Part(folder.cell("cell"), 0, 1)) as writer:
        writer.add(episodes, tools.results(episodes))
        writer.seal()
    monkeypatch.setattr(bounded_parquet, "allowed", lambda size: 1000)
    with pytest.raises(CorruptPartError, match=r"holds more than 1000 bytes"):
        list(Part(folder.cell("cell"), 0, 1).episodes())


def test_kinds_of_command_are_kept_and_older_parts_have_none(tools, run):
    folder = RunFolder.start(run, tools.manifest())
    twist = np.array([True, False, True])
    episode = dataclasses.replace(tools.episode(np.random.default_rng(0), 0), twist=twist)
    part = Part(folder.cell("cell"), 0, 1)
    with PartWriter(part) as writer:
        writer.add([episode], tools.results([episode]))
        writer.seal()
    (back,) = part.episodes()
    np.testing.assert_array_equal(back.twist, twist)
    table = pq.read_table(part.path(EPISODES_FILE)).drop_columns(["twist"])
    (older,) = from_table(table)
    assert older.twist is None
