"""Runs from before schema 6, whose manifests have the key `says`, are read like new ones."""

import hashlib
import json
from pathlib import Path

import pytest

from benchnav.api.records.run import open_run
from benchnav.errors import CorruptPartError
from benchnav.store.packs.unpack import opened
from benchnav.store.runs import checked_json
from benchnav.store.runs.manifest import SCHEMA, Manifest, load_manifest, parse_manifest
from benchnav.store.runs.run_folder import RunFolder
from benchnav.verify.verify import Wanted, verify

OLD_RUN = Path(__file__).with_name("run-of-0.1.0.bnrun")
SUITE = {
    "name": "own", "version": 1, "split": "test", "seeds": [0, 4], "tracks": ["known"],
    "scenarios": [{"scenario": "a/b@1", "hash": "f" * 16, "says": {"title": "x"}, "files": {}}],
    "navigators": [
        {
            "label": "led", "says": {"type": "guided"}, "source": "theirs 1.0", "rehearsal": 2,
            "leader": {"label": "orca", "says": {"type": "orca"}, "source": "benchnav 0.1.0"},
        }
    ],
}  # fmt: skip
HASH = hashlib.sha256(json.dumps(SUITE, sort_keys=True, separators=(",", ":")).encode()).hexdigest()


def stored(schema: int = 5, **suite: object) -> str:
    """Return the text of a manifest as version 0.1.0 wrote it."""
    return checked_json.dump(
        {
            "suite": {**SUITE, **suite}, "cells": [], "salt": "5a", "limits": {}, "shard": "",
            "sources": {}, "unguarded": [], "schema": schema, "versions": {"benchnav": "0.1.0"},
            "platform": "Linux", "created": "2026-01-01T00:00:00+00:00", "suite_hash": HASH,
        }
    )  # fmt: skip


def test_an_old_manifest_is_read_with_the_new_key_and_keeps_its_hash():
    manifest = parse_manifest(stored(), Path("manifest.json"))
    (navigator,), (scenario,) = manifest.suite["navigators"], manifest.suite["scenarios"]
    assert navigator["config"] == {"type": "guided"}
    assert navigator["leader"]["config"] == {"type": "orca"}
    assert scenario["config"] == {"title": "x"}
    assert manifest.suite_hash == HASH
    assert Manifest(manifest.suite, ()).suite_hash == HASH  # of a new run of the same suite


def test_an_old_manifest_is_written_again_as_it_was(tmp_path):
    text = stored()
    assert '"config"' not in text
    assert json.loads(parse_manifest(text, tmp_path).dump())["suite"] == SUITE


def test_an_old_run_is_resumed(tmp_path):
    (tmp_path / "manifest.json").write_text(stored())
    suite = parse_manifest(stored(), tmp_path).suite
    assert RunFolder.start(tmp_path, Manifest(suite, (), salt="5a")).manifest.schema == 5


def test_a_new_manifest_has_the_new_key_alone(tmp_path):
    new = Manifest(parse_manifest(stored(), tmp_path).suite, (), salt="5a")
    RunFolder(tmp_path, new).kept()
    text = (tmp_path / "manifest.json").read_text()
    assert '"says"' not in text
    assert json.loads(text)["schema"] == SCHEMA
    assert load_manifest(tmp_path).suite == new.suite


def test_a_new_manifest_with_the_old_key_is_refused(tmp_path):
    with pytest.raises(CorruptPartError, match="config must be given"):
        parse_manifest(stored(SCHEMA), tmp_path)


def test_both_keys_are_refused(tmp_path):
    both = [{**SUITE["navigators"][0], "config": {}}]
    with pytest.raises(CorruptPartError, match="is damaged"):
        parse_manifest(stored(navigators=both), tmp_path)


def test_a_published_pack_is_read():
    run = open_run(OLD_RUN)
    assert run.folder.manifest.schema < SCHEMA
    assert all(entry["config"]["type"] for entry in run.folder.manifest.suite["navigators"])


@pytest.mark.slow
def test_a_published_pack_is_verified_and_ranked():
    with opened(OLD_RUN) as folder:
        report = verify(folder, Wanted(twin=1), workers=0)
        assert report.findings == []
        assert report.counts["episodes"] > 50
    assert "orca" in open_run(OLD_RUN).leaderboard().to_markdown()
