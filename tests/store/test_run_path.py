"""A run is named by text or by a path; anything else gets a sentence."""

from pathlib import Path

import pytest

from benchnav.errors import StoreError, UsageError
from benchnav.runner.execute.measurement import measure_again
from benchnav.store.packs.unpack import opened
from benchnav.store.runs.manifest import load_manifest
from benchnav.store.runs.merge import merge
from benchnav.store.runs.reading import (
    read_episodes,
    read_episodes_in_every_track,
    read_rehearsals,
    read_results,
)
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.run_path import run_path

READERS = (
    read_episodes, read_episodes_in_every_track, read_rehearsals, read_results, load_manifest,
    RunFolder.open, lambda run: opened(run).__enter__(), lambda run: measure_again(run, []),
    lambda run: merge([run], "out"),
)  # fmt: skip


class Named:
    def __fspath__(self):
        return "runs/a"


def test_text_and_paths_are_alike():
    for given in ("runs/a", Path("runs/a"), Named()):
        assert run_path(given) == Path("runs/a")


@pytest.mark.parametrize("read", READERS)
@pytest.mark.parametrize("given", [None, 3, b"r1", ["r1"], "", "r\0"])
def test_anything_else_is_refused_at_once(read, given):
    with pytest.raises(UsageError, match=r"A run must be named by the path of its folder.* Got "):
        read(given)


@pytest.mark.parametrize("read", READERS)
def test_text_names_a_run(read, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(StoreError, match="nowhere must be a run folder"):
        read("nowhere")
    assert list(tmp_path.iterdir()) == []
