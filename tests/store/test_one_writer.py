"""Several processes that begin in one place: one of them writes, the others say so."""

import dataclasses
import os
from threading import Barrier, Thread

import numpy as np
import pytest

from benchnav.errors import BenchnavError, RunConflictError, UsageError
from benchnav.store.packs.pack import pack
from benchnav.store.packs.unpack import opened
from benchnav.store.parts.part import Part
from benchnav.store.parts.part_writer import PartWriter
from benchnav.store.runs.lock import LOCK, claimed
from benchnav.store.runs.manifest import MANIFEST, load_manifest
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.spans import SEED_END


def together(*actions):
    """What each of several threads returned or raised; all begin at the same moment."""
    barrier, found = Barrier(len(actions)), [None] * len(actions)

    def do(k):
        barrier.wait()
        try:
            found[k] = actions[k]()
        except BenchnavError as error:
            found[k] = error

    threads = [Thread(target=do, args=(k,)) for k in range(len(actions))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return found


@pytest.mark.parametrize("attempt", range(20))
def test_who_writes_a_new_run_made_its_manifest(attempt, tools, run):
    done = Barrier(5)

    def begin(k):
        try:
            folder = RunFolder.start(run, dataclasses.replace(tools.manifest(), salt=f"{k:02x}"))
            with folder.writing() as held:
                done.wait()
                return folder.manifest.salt, held.manifest.salt
        except RunConflictError:
            done.wait()
            raise

    found = together(*(lambda k=k: begin(k) for k in range(5)))
    (written,) = [salts for salts in found if isinstance(salts, tuple)]
    assert written == (load_manifest(run).salt,) * 2
    for error in found:
        if not isinstance(error, tuple):
            assert "must have one writer. The process" in str(error)
            assert "choose another folder" in str(error)


def test_the_manifest_of_a_writer_is_that_of_now(tools, run):
    early = RunFolder.start(run, tools.manifest())
    with RunFolder.open(run).writing() as other:
        other.amend({cell["key"]: "needs a map" for cell in other.manifest.cells})
    with early.writing() as held:
        assert {cell["reason"] for cell in held.manifest.cells} == {"needs a map"}


def test_a_process_that_was_killed_before_the_manifest_leaves_a_free_folder(tools, run):
    run.mkdir()
    (run / LOCK).write_text("12345")
    (run / f".writing-{MANIFEST}").write_text("half of it")
    RunFolder.start(run, tools.manifest())
    assert load_manifest(run).suite == tools.manifest().suite


def test_a_folder_with_other_things_gets_no_lock(tools, run):
    run.mkdir()
    (run / "thesis.tex").write_text("")
    with pytest.raises(RunConflictError, match="It has other content"):
        RunFolder.start(run, tools.manifest())
    assert [path.name for path in run.iterdir()] == ["thesis.tex"]


@pytest.fixture
def small(tools, run):
    folder = RunFolder.start(run, tools.manifest())
    episodes = [tools.episode(np.random.default_rng(0), seed) for seed in range(3)]
    with PartWriter(Part(folder.cell("cell"), 0, 3)) as writer:
        writer.add(episodes, tools.results(episodes))
        writer.seal()
    return folder


def test_of_several_packs_into_one_file_one_is_written_and_whole(small, tmp_path):
    out = tmp_path / "run.bnrun"
    found = together(*(lambda: pack(small, out) for _ in range(4)))
    assert found.count(None) == 1
    assert all(isinstance(error, None | RunConflictError | UsageError) for error in found)
    with opened(out) as folder:
        assert folder.done("cell") == {0, 1, 2}
    assert not list(tmp_path.glob(".writing-*"))


def test_what_a_killed_pack_left_is_taken_over_and_what_is_being_written_is_not(small, tmp_path):
    out = tmp_path / "run.bnrun"
    temporary = tmp_path / ".writing-run.bnrun"
    temporary.write_bytes(os.urandom(1 << 20))
    with claimed(temporary), pytest.raises(RunConflictError, match="Another process writes it"):
        pack(small, out)
    assert not out.exists()
    pack(small, out)
    assert out.stat().st_size < 1 << 20
    assert not temporary.exists()


@pytest.mark.parametrize("first", [10**6 - 1, 10**9 - 1, 10**9, 10**12, SEED_END - 2])
def test_seeds_of_every_size_are_stored_and_found_and_packed(first, tools, run, tmp_path):
    seeds = [first, first + 1]
    folder = RunFolder.start(run, tools.manifest(seeds=[first, first + 2]))
    episodes = [tools.episode(np.random.default_rng(0), seed) for seed in seeds]
    with PartWriter(Part(folder.cell("cell"), *map(int, (first, first + 2)))) as writer:
        writer.add(episodes, tools.results(episodes))
        writer.seal()
    with folder.writing() as held:  # which removes leftovers
        assert held.done("cell") == set(seeds)
    pack(folder, tmp_path / "run.bnrun")
    with opened(tmp_path / "run.bnrun") as other:
        assert other.done("cell") == set(seeds)
