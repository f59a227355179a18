"""Manifests name the code, the machine and the command that made a run."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from benchnav.errors import CorruptPartError
from benchnav.store.packs.unpack import opened
from benchnav.store.runs import provenance
from benchnav.store.runs.manifest import MANIFEST, load_manifest
from benchnav.store.runs.run_folder import RunFolder

MADE = {"commit": "a" * 40, "dirty": True, "processor": "A CPU", "command": "benchnav run quick"}


def test_a_checkout_tells_its_commit_and_whether_it_was_changed(tmp_path, monkeypatch):
    def git(*words):
        settings = ("-c", "user.name=n", "-c", "user.email=e")
        command = ["git", "-C", str(tmp_path), *settings, *words]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()

    git("init", "-q")
    (tmp_path / "pyproject.toml").write_text("")
    git("add", ".")
    git("commit", "-qm", "first")
    monkeypatch.setattr(provenance, "_ROOT", tmp_path)
    assert provenance.commit() == {"commit": git("rev-parse", "HEAD"), "dirty": False}
    (tmp_path / "pyproject.toml").write_text("changed")
    assert provenance.commit()["dirty"]
    monkeypatch.setenv("PATH", "")
    assert provenance.commit() == {"commit": "", "dirty": False}


def test_the_command_line_hides_the_home_folder_and_is_bounded(monkeypatch):
    home = str(Path.home())
    words = [f"{home}/bin/benchnav", "run", f"{home}/mine.yaml", "a b"]
    monkeypatch.setattr(sys, "argv", words)
    assert provenance.command_line() == "benchnav run ~/mine.yaml 'a b'"
    monkeypatch.setattr(sys, "argv", [*words, "x" * 5_000])
    assert len(provenance.command_line()) == provenance.LONGEST


def test_what_is_found_here_can_be_stored_and_read(tools, run, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["benchnav", "run", "quick"])
    found = provenance.provenance()
    assert found["processor"]
    _store(tools, run, found)
    assert load_manifest(run).provenance == found


@pytest.mark.parametrize(
    ("key", "value"),
    [("commit", "HEAD"), ("dirty", "no"), ("processor", "x" * 201), ("command", 3), ("who", "me")],
)
def test_other_values_are_refused_with_key(tools, run, key, value):
    _store(tools, run, {**MADE, key: value})
    with pytest.raises(CorruptPartError, match=f"provenance.{key}"):
        load_manifest(run)


def test_runs_of_0_1_have_none():
    with opened(Path(__file__).with_name("run-of-0.1.0.bnrun")) as folder:
        assert folder.manifest.versions["benchnav"] == "0.1.0"
        assert folder.manifest.provenance == {}
        assert provenance.sentence(folder.manifest.provenance) == ""


def test_it_is_put_in_words():
    assert provenance.sentence(MADE) == (
        f", commit {'a' * 40} with changes that were not committed, processor 'A CPU',"
        " command 'benchnav run quick'"
    )


def _store(tools, run, found):
    fields = json.loads(RunFolder.start(run, tools.manifest()).manifest.dump())
    del fields["sha256"]
    (run / MANIFEST).write_text(json.dumps({**fields, "provenance": found}))
