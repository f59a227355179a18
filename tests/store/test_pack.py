"""One file of a run, the same whenever it is made; and files that only pretend to be one."""

import hashlib
import json
import stat
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest

from benchnav.errors import CorruptPartError, StoreError, UsageError
from benchnav.store.packs.pack import INDEX, content_digest, members, pack
from benchnav.store.packs.unpack import opened
from benchnav.store.parts.part import Part
from benchnav.store.parts.part_writer import PartWriter
from benchnav.store.runs.reading import read_episodes
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.scenario_files import keep_files, sha256_of


def scenario(files):
    return {"scenario": "a/b@1", "hash": "f" * 64, "config": {}, "files": files}


@pytest.fixture
def packed(tools, run, tmp_path):
    """A run of one part and one scenario's file, and its pack."""
    source = tmp_path / "a.map"
    source.write_bytes(b"map")
    scenarios = [scenario({"a.map": sha256_of(source)})]
    folder = RunFolder.start(run, tools.manifest(scenarios=scenarios))
    keep_files(run, {"a.map": source})
    episodes = [tools.episode(np.random.default_rng(0), seed) for seed in range(3)]
    with PartWriter(Part(folder.cell("cell"), 0, 3)) as writer:
        writer.add(episodes, tools.results(episodes))
        writer.seal()
    (folder.cell("cell") / ".writing-x").write_text("left over")
    (run / "secret.txt").write_text("not of the run")
    out = tmp_path / "run.bnrun"
    pack(folder, out)
    return out


def test_it_holds_the_run_and_nothing_else(packed, run):
    with opened(packed) as folder:
        back = [episode.digest for episode in read_episodes(folder.path)]
        assert list(members(folder)) == list(members(RunFolder.open(run)))
        assert content_digest(folder) == content_digest(RunFolder.open(run))
        assert folder.shown == packed
        held = folder.path
    assert back == [episode.digest for episode in read_episodes(run)]
    assert not held.exists()
    with zipfile.ZipFile(packed) as archive:
        assert not any("secret" in name or "writing" in name for name in archive.namelist())


def test_the_same_run_gives_the_same_bytes(packed, run, tmp_path):
    pack(RunFolder.open(run), tmp_path / "again.bnrun")
    assert (tmp_path / "again.bnrun").read_bytes() == packed.read_bytes()
    with pytest.raises(UsageError, match="must be a new file"):
        pack(RunFolder.open(run), packed)


def test_a_file_that_lacks_or_has_a_whole_path_is_refused(packed, run, tools, tmp_path):
    for kept in (run / "files").iterdir():
        kept.unlink()
    with pytest.raises(StoreError, match="must be a file of a run"):
        pack(RunFolder.open(run), tmp_path / "other.bnrun")
    scenarios = [scenario({"/etc/passwd": "0" * 64})]
    folder = RunFolder.start(tmp_path / "whole", tools.manifest(scenarios=scenarios))
    with pytest.raises(UsageError, match="must name its files relative"):
        pack(folder, tmp_path / "other.bnrun")
    assert not (tmp_path / "other.bnrun").exists()


def forged(packed, change, target, compression=zipfile.ZIP_STORED):
    """The pack with other members: ``change`` gets and gives a list of (ZipInfo, bytes)."""
    with zipfile.ZipFile(packed) as archive:
        found = [(info, archive.read(info)) for info in archive.infolist()]
    with zipfile.ZipFile(target, "w", compression) as archive:
        for info, content in change(found):
            archive.writestr(info, content, compression)
    return target


def with_index(found):
    """The index made to fit."""
    files = {
        info.filename: {"bytes": len(content), "sha256": hashlib.sha256(content).hexdigest()}
        for info, content in found[1:]
    }
    return [(found[0][0], json.dumps({"format": 1, "files": files}).encode()), *found[1:]]


def info(name, mode=stat.S_IFREG | 0o644):
    made = zipfile.ZipInfo(name)
    made.external_attr = mode << 16
    return made


@pytest.mark.parametrize(
    "name",
    ["../evil", "/etc/evil", "parts/../../evil", "parts/cell/../../evil.seal.json", "C:\\evil",
     "parts/.hid/000000-000003.seal.json", "files/../manifest.json", "evil", "parts/",
     "parts/cell/000000-000003.seal.json\n"],
)  # fmt: skip
def test_members_cannot_escape(packed, tmp_path, name):
    path = forged(packed, lambda found: with_index([*found, (info(name), b"x")]), tmp_path / "f")
    before = set(tmp_path.rglob("*"))
    with pytest.raises(CorruptPartError, match="unknown member"), opened(path):
        pass
    assert set(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("kind", [stat.S_IFLNK, stat.S_IFIFO, stat.S_IFDIR])
def test_links_and_devices_are_refused(packed, tmp_path, kind):
    link = info("files/" + "0" * 64, kind | 0o777)
    path = forged(packed, lambda found: with_index([*found, (link, b"/etc")]), tmp_path / "f")
    with pytest.raises(CorruptPartError, match="not a plain file"), opened(path):
        pass


def test_bombs_are_refused(packed, tmp_path):
    deflated = forged(packed, lambda found: found, tmp_path / "f", zipfile.ZIP_DEFLATED)
    with pytest.raises(CorruptPartError, match="is compressed"), opened(deflated):
        pass
    # members that share their bytes: the directory says more than the file holds
    data = packed.read_bytes()
    where = data.rindex(b"PK\x05\x06")
    start = struct.unpack("<I", data[where + 16 : where + 20])[0]
    entry = data[start:where]
    many = 40
    count = struct.unpack("<H", data[where + 10 : where + 12])[0]
    end = struct.pack(
        "<4s4H2IH", b"PK\x05\x06", 0, 0, count * many, count * many, len(entry) * many, start, 0
    )
    overlapping = tmp_path / "overlapping"
    overlapping.write_bytes(data[:start] + entry * many + end)
    with pytest.raises(StoreError), opened(overlapping):
        pass


def test_sizes_are_what_was_declared(packed, tmp_path):
    data = packed.read_bytes()
    with zipfile.ZipFile(packed) as archive:
        largest = max(archive.infolist(), key=lambda member: member.file_size)
    size = struct.pack("<I", largest.file_size)
    for wrong in (largest.file_size + 10**9, largest.file_size - 1):
        path = tmp_path / f"{wrong}"
        path.write_bytes(data.replace(size, struct.pack("<I", wrong)))
        with pytest.raises(StoreError), opened(path):
            pass


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (lambda found: found[1:], f"It has no {INDEX}"),
        (lambda found: [found[0], *found[2:]], "other members"),
        (lambda found: [(found[0][0], b"{}"), *found[1:]], "cannot be read"),
        (lambda found: [(found[0][0], b"[" * 100000), *found[1:]], "cannot be read"),
        (lambda found: [(found[0][0], b'{"format": 9}'), *found[1:]], "format must be 1"),
        (lambda found: [*found[:-1], (found[-1][0], b"x" * len(found[-1][1]))], "another sha256"),
    ],
)
def test_what_was_changed_is_refused(packed, tmp_path, change, complaint):
    path = forged(packed, change, tmp_path / "f")
    with pytest.raises(StoreError, match=complaint), opened(path) as folder:
        list(read_episodes(folder.path))


def test_messages_name_the_pack_and_not_where_it_lay_meanwhile(packed, tmp_path):
    def change(found):
        return with_index([*found[:-1], (found[-1][0], b"x")])  # the seal

    path = forged(packed, change, tmp_path / "theirs.bnrun")
    with pytest.raises(StoreError) as refused, opened(path) as folder:
        list(read_episodes(folder.path))
    assert str(path) in str(refused.value)
    assert "benchnav-pack-" not in str(refused.value)


def test_what_is_no_pack_is_refused(tmp_path):
    for content in (b"", b"PK", b"x" * 1000):
        (tmp_path / "f").write_bytes(content)
        with (
            pytest.raises(StoreError, match="or a pack of 'benchnav pack'"),
            opened(tmp_path / "f"),
        ):
            pass
    with pytest.raises(StoreError), opened(Path(tmp_path / "gone")):
        pass
