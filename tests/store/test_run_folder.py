"""A run folder is append-only, resumable, and refuses what does not belong to it."""

import dataclasses
import json
import os
import resource

import numpy as np
import pytest

from benchnav.errors import CorruptPartError, RunConflictError, StoreError
from benchnav.store.parts import part_writer
from benchnav.store.parts.part import EPISODES_FILE, RESULTS_FILE, SEAL, Part
from benchnav.store.parts.part_writer import TEMPORARY, PartWriter
from benchnav.store.parts.results import RESULTS
from benchnav.store.runs import lock
from benchnav.store.runs.manifest import MANIFEST, load_manifest
from benchnav.store.runs.reading import read_episodes, read_results
from benchnav.store.runs.run_folder import RunFolder
from tests.store.conftest import HASH


def write(tools, folder, first, stop, cell="cell"):
    rng = np.random.default_rng(first)
    episodes = [tools.episode(rng, seed) for seed in range(first, stop)]
    with PartWriter(Part(folder.cell(cell), first, stop)) as writer:
        writer.add(episodes[:1], tools.results(episodes[:1]))
        writer.add(episodes[1:], tools.results(episodes[1:]))
        writer.seal()
    return episodes


def test_parts_are_read_back_by_seed(tools, run):
    folder = RunFolder.start(run, tools.manifest())
    late = write(tools, folder, 3, 5)
    early = write(tools, folder, 0, 3)
    back = list(read_episodes(run))
    assert [e.identity.seed for e in back] == [0, 1, 2, 3, 4]
    for left, right in zip(early + late, back, strict=True):
        tools.same(left, right)
    assert read_results(run).column("seed").to_pylist() == [0, 1, 2, 3, 4]
    assert folder.done("cell") == {0, 1, 2, 3, 4}


def test_results_of_before_navigators_had_hashes_are_read(tools, run, monkeypatch):
    folder = RunFolder.start(run, dataclasses.replace(tools.manifest(), schema=1))
    old = [tools.episode(np.random.default_rng(0), 0)]
    before = RESULTS.remove(RESULTS.get_field_index("navigator_hash"))
    with monkeypatch.context() as then:
        then.setattr(part_writer, "RESULTS", before)
        with PartWriter(Part(folder.cell("cell"), 0, 1)) as writer:
            writer.add(old, tools.results(old).drop_columns(["navigator_hash"]))
            writer.seal()
    write(tools, folder, 1, 3)
    assert read_results(run).column("navigator_hash").to_pylist() == ["", HASH, HASH]


def test_nothing_is_visible_before_the_seal_and_leftovers_are_swept(tools, run):
    folder = RunFolder.start(run, tools.manifest())
    write(tools, folder, 0, 2)
    with pytest.raises(KeyError), PartWriter(Part(folder.cell("cell"), 2, 4)):
        raise KeyError
    assert not list(folder.cell("cell").glob(f"{TEMPORARY}*"))
    stray = folder.cell("cell") / f"{TEMPORARY}000004-000006{EPISODES_FILE}"
    stray.write_bytes(b"half")
    unsealed = folder.cell("cell") / f"000006-000008{RESULTS_FILE}"
    unsealed.write_bytes(b"whole, but never sealed")
    assert folder.done("cell") == {0, 1}
    with folder.writing():
        assert not stray.exists()
        assert not unsealed.exists()
    assert len(list(read_episodes(run))) == 2


def test_the_same_suite_resumes_and_another_is_refused_by_name(tools, run):
    first = RunFolder.start(run, tools.manifest())
    again = RunFolder.start(run, tools.manifest())
    assert again.manifest == first.manifest
    with pytest.raises(RunConflictError) as refused:
        RunFolder.start(run, tools.manifest(name="other", seeds=[0, 5]))
    assert "other@1" in str(refused.value)
    assert "tiny@1" in str(refused.value)
    assert "They differ in name, seeds." in str(refused.value)


def test_a_folder_with_something_else_is_refused(tools, tmp_path):
    (tmp_path / "thesis.tex").write_text("x")
    with pytest.raises(RunConflictError, match="It has other content"):
        RunFolder.start(tmp_path, tools.manifest())
    assert (tmp_path / "thesis.tex").read_text() == "x"
    with pytest.raises(RunConflictError):
        RunFolder.start(tmp_path / "thesis.tex", tools.manifest())


def test_a_system_without_locks_has_one_writer_too(tools, run, monkeypatch):
    monkeypatch.setattr(lock, "fcntl", None)
    folder = RunFolder.start(run, tools.manifest())
    with folder.writing():
        with pytest.raises(RunConflictError, match=rf"The process {os.getpid()} writes it now"):
            folder.writing().__enter__()
        assert (run / lock.MARK).exists()
    assert not (run / lock.MARK).exists()
    (run / lock.MARK).write_text("12345")
    with pytest.raises(
        RunConflictError, match=r"12345 .* delete .*\.writer if that process was killed"
    ):
        folder.writing().__enter__()
    assert (run / lock.MARK).exists()
    (run / lock.MARK).unlink()
    with folder.writing():
        pass


def test_a_system_that_opens_no_folders_seals_parts(tools, run, monkeypatch):
    monkeypatch.delattr(os, "O_DIRECTORY")
    folder = RunFolder.start(run, tools.manifest())
    write(tools, folder, 0, 2)
    assert folder.done("cell") == {0, 1}


def test_two_writers_are_refused(tools, run):
    folder = RunFolder.start(run, tools.manifest())
    with folder.writing(), pytest.raises(RunConflictError, match=r"one writer\. The process \d+"):
        folder.writing().__enter__()
    with folder.writing():
        pass


@pytest.mark.parametrize("suffix", [EPISODES_FILE, RESULTS_FILE])
@pytest.mark.parametrize("damage", ["cut", "flip", "gone", "seal"])
def test_a_damaged_part_is_named_and_can_be_redone(tools, run, suffix, damage):
    folder = RunFolder.start(run, tools.manifest())
    write(tools, folder, 0, 2)
    part = Part(folder.cell("cell"), 0, 2)
    path = part.path(SEAL if damage == "seal" else suffix)
    content = path.read_bytes()
    if damage == "gone":
        path.unlink()
    elif damage == "flip":
        middle = len(content) // 2
        path.write_bytes(content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :])
    else:
        path.write_bytes(content[: len(content) // 2])
    with pytest.raises(CorruptPartError) as refused:
        list(read_episodes(run)), read_results(run)
    assert str(path) in str(refused.value)
    assert "Delete" in str(refused.value)
    part.path(SEAL).unlink()
    with folder.writing():
        assert folder.done("cell") == set()
    write(tools, folder, 0, 2)
    assert len(list(read_episodes(run))) == 2


def test_no_run_and_a_damaged_manifest_are_told_apart(tools, run):
    with pytest.raises(StoreError, match="It does not exist"):
        load_manifest(run)
    run.mkdir()
    with pytest.raises(StoreError, match="It has none"):
        load_manifest(run)
    RunFolder.start(run, tools.manifest())
    said = json.loads((run / MANIFEST).read_text())
    del said["sha256"]
    (run / MANIFEST).write_text(json.dumps({**said, "schema": 99}))
    with pytest.raises(StoreError, match=r"schema must be at most 9\. Got 99"):
        load_manifest(run)
    (run / MANIFEST).write_text(json.dumps({**said, "suite": {**said["suite"], "name": "forged"}}))
    with pytest.raises(CorruptPartError, match="Its suite was changed"):
        load_manifest(run)
    (run / MANIFEST).write_text("{")
    with pytest.raises(CorruptPartError, match="cannot be read"):
        load_manifest(run)


def test_a_disk_that_refuses_is_an_error_that_says_how_to_go_on(tools, run):
    """The system's own limit on the size of a file stands in for a full disk."""
    folder = RunFolder.start(run, tools.manifest())
    write(tools, folder, 0, 2)
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2000, hard))
    try:
        with pytest.raises(StoreError) as refused:
            write(tools, folder, 2, 60)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert "is not writable, or the disk is full" in str(refused.value)
    assert f"again into {run} to continue" in str(refused.value)
    assert folder.done("cell") == {0, 1}
    assert len(list(folder.cell("cell").iterdir())) == 3
