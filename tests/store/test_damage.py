"""Whatever happens to a byte of a run, nobody reads something else without being told."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchnav.errors import CorruptPartError, StoreError
from benchnav.store.parts.part import REHEARSALS_FILE, SEAL, Part, parts_of
from benchnav.store.parts.part_writer import PartWriter
from benchnav.store.runs import checked_json
from benchnav.store.runs.lock import LOCK
from benchnav.store.runs.manifest import load_manifest
from benchnav.store.runs.reading import read_episodes, read_rehearsals, read_results
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.spans import without

PARTS = ((0, 3), (3, 4))


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A run of two parts with rehearsals, and all that can be read of it."""
    from tests.store.conftest import make_episode, make_manifest, make_results

    run = tmp_path_factory.mktemp("runs") / "run"
    folder = RunFolder.start(run, make_manifest(rehearsal=1))
    rng = np.random.default_rng(0)
    with folder.writing():
        for first, stop in PARTS:
            drawn = [make_episode(rng, seed, steps=2) for seed in range(first, stop)]
            episodes = [replace(e, rehearsals=1) for e in drawn]
            practice = [replace(e, identity=replace(e.identity, rehearsal=1)) for e in drawn]
            with PartWriter(Part(folder.cell("cell"), first, stop)) as writer:
                writer.add(episodes, make_results(episodes), practice)
                writer.seal()
    return run, everything(run)


def everything(run):
    """All that readers of a run are given, as something that can be compared."""
    manifest = load_manifest(run)
    told = [(e.identity, e.digest, e.position.tobytes()) for e in read_episodes(run)]
    told += [(e.identity, e.digest, e.position.tobytes()) for e in read_rehearsals(run)]
    return manifest, told, read_results(run), list(RunFolder.open(run).missing())


def files(run):
    return sorted(p for p in run.rglob("*") if p.is_file() and p.name != LOCK)


@settings(max_examples=150)
@given(data=st.data())
def test_no_flipped_bit_goes_unseen(whole, data):
    run, before = whole
    path = data.draw(st.sampled_from(files(run)))
    content = path.read_bytes()
    at = data.draw(st.integers(0, len(content) - 1))
    bit = data.draw(st.integers(0, 7))
    path.write_bytes(content[:at] + bytes([content[at] ^ 1 << bit]) + content[at + 1 :])
    try:
        with pytest.raises(StoreError) as told:
            everything(run)
        assert path.parent.name in str(told.value)
    finally:
        path.write_bytes(content)
    assert everything(run) == before


@settings(max_examples=50)
@given(data=st.data())
def test_nothing_that_was_cut_short_goes_unseen(whole, data):
    run, before = whole
    path = data.draw(st.sampled_from(files(run)))
    content = path.read_bytes()
    kept = data.draw(st.integers(0, len(content) - 1))
    path.write_bytes(content[:kept])
    try:
        if content[kept:] == b"\n":  # says nothing
            assert everything(run) == before
        else:
            with pytest.raises(StoreError):
                everything(run)
    finally:
        path.write_bytes(content)


def test_nothing_that_is_gone_goes_unseen(whole):
    run, before = whole
    for path in files(run):
        content = path.read_bytes()
        path.unlink()
        try:
            if path.name.endswith(SEAL):  # as if it had never been run: it is missing
                first, stop = (int(x) for x in path.name.removesuffix(SEAL).split("-"))
                ((_, seeds),) = everything(run)[3]
                assert not without([(first, stop)], seeds)
            else:
                with pytest.raises(StoreError):
                    everything(run)
        finally:
            path.write_bytes(content)
    assert everything(run) == before


def test_what_was_sealed_before_seals_were_checked_is_read(whole):
    run, before = whole
    for path in run.glob(f"parts/*/*{SEAL}"):
        said = json.loads(path.read_text())
        del said[checked_json.KEY]
        path.write_text(json.dumps(said))
    assert everything(run) == before
    seal = next(run.glob(f"parts/*/*{SEAL}"))
    said = seal.read_text()
    seal.write_text(said.replace(REHEARSALS_FILE, ".rehearsbls.parquet"))
    with pytest.raises(CorruptPartError, match=r"unknown key '\.rehearsbls\.parquet'"):
        everything(run)
    seal.write_text(said)


def test_only_names_of_parts_are_parts(tmp_path):
    for name in ("²-³", "1-2", "000001-", "000000-000002-000004", "000000-9999999999"):
        (tmp_path / f"{name}{SEAL}").write_text("{}")
    (tmp_path / f"000000-000002{SEAL}").write_text("{}")
    assert parts_of(tmp_path) == [Part(tmp_path, 0, 2)]


def test_a_seal_under_another_name_is_no_seal(whole):
    run, _ = whole
    part = Part(RunFolder.open(run).cell("cell"), 3, 4)
    other = Part(part.folder, 3, 6)
    for path in part.folder.glob(f"{part.stem}*"):
        other.path(path.name.removeprefix(part.stem)).write_bytes(path.read_bytes())
    with pytest.raises(CorruptPartError, match="is of 1 episodes, and its name is of 3"):
        other.check()
