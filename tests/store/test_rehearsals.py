"""Rehearsals lie beside the episodes that they were made for, sealed like them."""

from dataclasses import replace

import numpy as np
import pytest

from benchnav.errors import CorruptPartError
from benchnav.store.parts.part import REHEARSALS_FILE, SEAL, Part
from benchnav.store.parts.part_writer import TEMPORARY, PartWriter
from benchnav.store.runs.reading import read_episodes, read_rehearsals
from benchnav.store.runs.run_folder import RunFolder


def made(tools, seed, rehearsal):
    episode = tools.episode(np.random.default_rng([seed, rehearsal]), seed)
    identity = replace(episode.identity, rehearsal=rehearsal)
    timings = replace(episode.timings, rehearsal=0.1 * seed)
    count = 0 if rehearsal else 2
    remarks = () if rehearsal else ("a wall – «stands» there", "and another")[: seed + 1]
    return replace(
        episode, identity=identity, timings=timings, rehearsals=count,
        rehearsal_decisions=7 * count, remarks=remarks,
    )  # fmt: skip


@pytest.fixture
def written(tools, run):
    folder = RunFolder.start(run, tools.manifest(rehearsal=2))
    scored = [made(tools, seed, 0) for seed in range(2)]
    rehearsed = [made(tools, seed, k) for k in (1, 2) for seed in range(2)]
    with PartWriter(Part(folder.cell("cell"), 0, 2)) as writer:
        for episode in scored:
            own = [e for e in rehearsed if e.identity.seed == episode.identity.seed]
            writer.add([episode], tools.results([episode]), own)
        writer.seal()
    return folder, scored, rehearsed


def test_both_are_read_back_to_the_last_bit_and_apart(tools, run, written):
    _, scored, rehearsed = written
    for left, right in zip(scored, read_episodes(run), strict=True):
        tools.same(left, right)
    rehearsed.sort(key=lambda e: (e.identity.seed, e.identity.rehearsal))
    for left, right in zip(rehearsed, read_rehearsals(run), strict=True):
        tools.same(left, right)


def test_a_part_without_rehearsals_has_two_files_and_a_seal(tools, run, written):
    folder, scored, _ = written
    with PartWriter(Part(folder.cell("cell"), 2, 3)) as writer:
        writer.add(scored[:1], tools.results(scored[:1]))
        writer.seal()
    names = {path.name.partition(".")[2] for path in folder.cell("cell").glob("000002-*")}
    assert names == {"episodes.parquet", "results.parquet", "seal.json"}


@pytest.mark.parametrize("damage", ["gone", "cut", "changed"])
def test_damage_to_rehearsals_is_found(run, written, damage):
    folder, _, _ = written
    path = folder.cell("cell") / f"000000-000002{REHEARSALS_FILE}"
    data = bytearray(path.read_bytes())
    if damage == "gone":
        path.unlink()
    elif damage == "cut":
        path.write_bytes(data[:-9])
    else:
        data[len(data) // 2] ^= 1
        path.write_bytes(data)
    with pytest.raises(CorruptPartError, match=r"rehearsals\.parquet is damaged"):
        list(read_rehearsals(run))
    if damage != "changed":
        with pytest.raises(CorruptPartError):
            folder.done("cell")


def test_leftovers_are_swept(run, written):
    folder, _, _ = written
    unsealed = folder.cell("cell") / f"000008-000009{REHEARSALS_FILE}"
    half = folder.cell("cell") / f"{TEMPORARY}000009-000010{REHEARSALS_FILE}"
    for path in (unsealed, half):
        path.write_bytes(b"x")
    with folder.writing():
        assert not unsealed.exists()
        assert not half.exists()
    (folder.cell("cell") / f"000000-000002{SEAL}").unlink()
    with folder.writing():
        assert not list(folder.cell("cell").iterdir())
