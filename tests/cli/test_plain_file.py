"""Files that a user names: what is no file is refused at once, wherever it is named."""

import os
import socket
from pathlib import Path

import pytest
import yaml

from benchnav.system.plain_file import open_file, read_file, require_writable

KINDS = {"pipe": "a pipe", "folder": "a folder", "socket": "a socket", "device": "a device"}


@pytest.fixture(params=KINDS)
def strange(request, tmp_path, monkeypatch):
    """(makes something of a kind under a name, what messages call it)."""
    monkeypatch.chdir(tmp_path)

    def make(name):
        path = tmp_path / name
        if request.param == "pipe":
            os.mkfifo(path)
        elif request.param == "folder":
            path.mkdir()
        elif request.param == "device":
            path.symlink_to("/dev/zero")
        else:
            with socket.socket(socket.AF_UNIX) as opened:
                opened.bind(name)  # a short path, from this folder
        return path

    return make, KINDS[request.param]


def test_only_files_are_opened(strange):
    make, kind = strange
    for attempt in (open_file, lambda path: read_file(path, 10), require_writable):
        path = make(f"x{id(attempt)}")
        with pytest.raises(OSError, match=f"must be a file, and is {kind}"):
            attempt(path)


def test_a_file_is_read_up_to_the_limit(tmp_path):
    path = tmp_path / "sparse"
    with path.open("wb") as file:
        file.truncate(10 << 30)
    assert read_file(path, 100) == bytes(101)
    with open_file(path) as opened:
        assert opened.seekable()


def image(name):
    Path("m.yaml").write_text(
        f"image: {name}\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\n"
        "free_thresh: 0.196\n"
    )
    return ["import", "ros-map", "m.yaml", "--out", "o.yaml"]


def shaped(suite, **shape):
    return changed(suite, walls=[{"shape": shape}])


def changed(suite, **keys):
    """A scenario as that of the suite, with other keys."""
    scenario = suite.parent / "open.yaml"
    scenario.write_text(yaml.safe_dump({**yaml.safe_load(scenario.read_text()), **keys}))
    return ["validate", scenario]


PLACES = {
    "scenario": ("x.yaml", lambda _: ["validate", "x.yaml"]),
    "suite": ("x.yaml", lambda _: ["run", "x.yaml", "--out", "out"]),
    "scenario of a run": ("x.yaml", lambda s: ["run", s, "--scenario", "x.yaml", "--out", "out"]),
    "recipe": ("x.yaml", lambda _: ["train", "x.yaml", "--out", "out"]),
    "map": ("x.map", lambda s: shaped(s, type="occupancy", file="x.map", format="movingai")),
    "image": ("x.png", lambda _: image("x.png")),
    "mesh": ("x.stl", lambda s: shaped(s, type="mesh", file="x.stl", unit=1)),
    "track": ("x.txt", lambda s: changed(s, dynamic=[{
        "shape": {"type": "disc", "radius": 0.3},
        "law": {"type": "recorded-track", "file": "x.txt", "format": "text", "frame_time": 0.4},
    }])),
    "imported map": ("x.map", lambda _: ["import", "movingai", "x.map", "--out", "o.yaml"]),
    "imported yaml": ("x.yaml", lambda _: ["import", "ros-map", "x.yaml", "--out", "o.yaml"]),
    "weights": ("x.safetensors", lambda s: [
        "run", s, "--navigator", "{type: q-learning, table: x.safetensors}", "--out", "out",
        "--workers", "0"]),
}  # fmt: skip


@pytest.mark.parametrize("place", PLACES)
def test_every_command_refuses_what_is_no_file(place, strange, call, suite, tmp_path):
    make, kind = strange
    name, arguments = PLACES[place]
    make(name)
    code, _, stderr = call(*arguments(suite))
    assert code == 2
    assert name in stderr
    said = (f"it must be a file, and is {kind}", f"{name} is not one", f"there is no {name}")
    assert any(text in stderr for text in said), stderr
    assert stderr.count("\n") <= 2


def test_a_run_or_pack_must_be_one(strange, call):
    make, _ = strange
    make("x.bnrun")
    for verb in ("leaderboard", "verify"):
        code, _, stderr = call(verb, "x.bnrun")
        assert code == 2
        assert "x.bnrun must be a run folder" in stderr


def test_results_are_written_into_files_only(strange, call, suite):
    make, kind = strange
    assert call("run", suite, "--out", "run", "--workers", "0", "--quiet")[0] == 0
    make("x.md")
    code, _, stderr = call("leaderboard", "run", "--out", "x.md")
    assert code == 1
    assert stderr.endswith(
        f"x.md must be writable. The system says: it must be a file, and is {kind}.\n"
    )
