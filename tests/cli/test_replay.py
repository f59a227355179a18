"""`benchnav replay` and `benchnav watch`: how episodes are named, and what a wrong name gets."""

import json
import re

import pytest

from benchnav.cli.main import status
from tests.viewer.test_replay import unpacked

SUITE = """\
name: small
scenarios: [trap/u]
tracks: [known]
navigators: [orca, straight-line]
seeds: 2
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("replay")
    (folder / "small.yaml").write_text(SUITE)
    assert status(["run", str(folder / "small.yaml"), "--out", str(folder / "run"), "--quiet"]) == 0
    return folder / "run"


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def scenes(path):
    text = path.read_text(encoding="utf-8")
    found = re.search(r'id="scenes">(.*?)</script>', text, re.DOTALL)
    return [
        (scene["navigator"], scene["seed"], len(unpacked(scene["status"])))
        for scene in json.loads(found[1])
    ]


def test_the_first_failed_episode_is_shown_by_default(run, here, capsys):
    assert status(["replay", str(run)]) == 0
    path = here / capsys.readouterr().out.strip()
    assert path.name == "replay-orca-trap-u-known-0.html"
    assert [found[:2] for found in scenes(path)] == [("orca", 0)]


def test_navigators_are_shown_side_by_side(run, here):
    words = ["--navigator", "straight-line", "--navigator", "orca", "--seed", "1"]
    assert status(["replay", str(run), *words, "--out", "both.html"]) == 0
    assert [found[:2] for found in scenes(here / "both.html")] == [
        ("straight-line", 1),
        ("orca", 1),
    ]


def test_listed_names_are_taken(run, here, capsys):
    assert status(["replay", str(run), "--list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split() == ["episode", "success", "duration", "cause"]
    assert re.fullmatch(r"\S+ +0 % +80\.0 s +timed out, got stuck", lines[1])
    names = [line.split()[0] for line in lines[1:]]
    assert names == [f"{n}/trap/u@1/known/{s}" for n in ("orca", "straight-line") for s in (0, 1)]
    assert status(["replay", str(run), names[3], names[0], "--out", "two.html"]) == 0
    found = [scene[:2] for scene in scenes(here / "two.html")]
    assert found == [("straight-line", 1), ("orca", 0)]
    assert status(["replay", str(run), "orca/trap/u/known/1", "--out", "new/one.html"]) == 0
    assert [scene[:2] for scene in scenes(here / "new/one.html")] == [("orca", 1)]


def test_the_worst_one_is_shown(run, here, capsys):
    assert status(["replay", str(run), "--worst", "success", "--list"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 1 + 4
    assert status(["replay", str(run), "--worst", "success", "--out", "w.html"]) == 0
    assert scenes(here / "w.html")


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--navigator", "orka"], "Did you mean 'orca'"),
        (["--seed", "9"], "holds no episode of seed 9"),
        (["--scenario", "trap/v"], "must be one that was run: trap/u. Got 'trap/v' instead"),
        (["--cause", "failed"], "No agent failed with the cause 'failed' in 4 stored episodes"),
        (["--cause", "stuk"], "Did you mean 'stuck'"),
        (["--failed", "stuck"], "Write --cause stuck"),
        (["orca/trap/u/known/0", "--navigator", "orca"], "not both"),
        (["orca/trap/u/known/0", "--list"], "not both"),
        (["--worst", "sucess"], "Did you mean 'success'"),
        (["--worst", "collisions_wall"], "'collisions_wall' has none"),
        (["nonsense"], "NAVIGATOR/SCENARIO/TRACK/SEED, such as orca/trap/u@1/known/0"),
        (["orca/trap/u@1/known/7"], "There is no stored episode 'orca/trap/u@1/known/7'"),
        (["orca/trap/u@1/stale/1"], "must be one that was run: known. Got 'stale' instead.\n"),
        (["--out", "a.mp5"], "Did you mean '.mp4'"),
        (["--agent", "77"], "from 0 to 3"),
        (["--time", "1"], "Times are for a figure"),
    ],
)
def test_a_wrong_name_is_answered_with_what_exists(run, here, capsys, words, sentence):
    assert status(["replay", str(run), *words]) == 2
    assert sentence in capsys.readouterr().err
    assert not list(here.iterdir())


def test_what_is_no_run_is_refused(here, capsys):
    assert status(["replay", "nothing"]) == 2
    message = capsys.readouterr().err
    assert "nothing" in message
    assert "benchnav run SUITE --out FOLDER" in message


def test_a_damaged_part_is_named(run, here, tmp_path, capsys):
    import shutil

    copy = tmp_path / "copy"
    shutil.copytree(run, copy)
    for path in copy.rglob("*episodes*.parquet"):
        path.write_bytes(path.read_bytes()[:-40])
    assert status(["replay", str(copy), "--seed", "0", "--navigator", "orca"]) == 1
    assert "orca" in capsys.readouterr().err


def test_watch_shows_what_happens(here, capsys):
    assert status(["watch", "trap/u", "orca", "straight-line", "--seed", "3", "--no-open"]) == 0
    path = here / capsys.readouterr().out.strip()
    assert [found[:2] for found in scenes(path)] == [("orca", 3), ("straight-line", 3)]
    assert status(["watch", "trap/u", "orka", "--no-open"]) == 2
    assert "Did you mean 'orca'" in capsys.readouterr().err
