"""A disk that is full and one that cannot be written, for real: in a mount namespace of our own."""

import os
import shutil
import subprocess
import sys

import pytest

from benchnav.store.parts.part import SEAL
from benchnav.store.runs.lock import LOCK

UNSHARE = ("unshare", "--mount", "--map-root-user")


def can_mount():
    if shutil.which("unshare") is None or shutil.which("mount") is None:
        return False
    tried = subprocess.run(
        [*UNSHARE, "mount", "-t", "tmpfs", "tmpfs", "/mnt"], capture_output=True, check=False
    )
    return tried.returncode == 0


pytestmark = pytest.mark.skipif(not can_mount(), reason="the system lets nobody mount a disk")

SCRIPT = """
mount -t tmpfs -o size=100k tmpfs disk
benchnav() { "$PYTHON" -c 'from benchnav.cli.main import main; main()' "$@"; }
tell() { echo "== $1"; shift; benchnav "$@" 2>&1; echo "status $?"; }
tell full run suite.yaml --out disk/run --seeds 120 --workers 1
ls disk/run/parts/* | sed 's/^/file /'
mount -o remount,size=20m disk
tell room run suite.yaml --out disk/run --seeds 120 --workers 1
mount -o remount,ro disk
tell again run suite.yaml --out disk/run --seeds 120 --workers 0
tell new run suite.yaml --out disk/other --seeds 120 --workers 0
tell read leaderboard disk/run --metric success
tell written leaderboard disk/run --out disk/table.md
"""


@pytest.mark.slow
def test_a_full_disk_and_a_read_only_one_are_told_and_nothing_is_lost(suite, tmp_path):
    (tmp_path / "disk").mkdir()
    done = subprocess.run(
        [*UNSHARE, "bash", "-c", SCRIPT], cwd=tmp_path, text=True, capture_output=True,
        env={**os.environ, "PYTHON": sys.executable}, timeout=300, check=True,
    )  # fmt: skip
    said = dict(block.split("\n", 1) for block in done.stdout.split("== ")[1:])
    assert "Traceback" not in done.stdout
    assert said["full"].count("status 1") == 1
    assert "is not writable, or the disk is full: No space left" in said["full"]
    kept = [line for line in said["full"].splitlines() if line.startswith("file ")]
    sealed = sum(line.endswith(SEAL) for line in kept)
    assert sealed > 0
    assert len([line for line in kept if ".parquet" in line or SEAL in line]) == 3 * sealed
    assert not [line for line in kept if "writing" in line]
    assert "status 0" in said["room"]
    stems = [line.removesuffix(SEAL).split()[-1] for line in kept if line.endswith(SEAL)]
    fresh = 240 - sum(int(stop) - int(first) for first, stop in (s.split("-") for s in stems))
    assert f"240 episodes stored, {fresh} of them run" in said["room"]
    assert "disk/run is not writable: Read-only file system" in said["again"]
    assert "is not writable: Read-only file system" in said["new"]
    assert "status 1" in said["again"]
    assert "status 1" in said["new"]
    assert "status 0" in said["read"]
    assert "120 worlds" in said["read"]
    assert "disk/table.md must be writable" in said["written"]


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_may_not_be_written_is_told(call, suite, tmp_path):
    assert call("run", suite, "--out", tmp_path / "run", "--quiet", "--workers", "0")[0] == 0
    (tmp_path / "run" / LOCK).chmod(0o444)
    (tmp_path / "run").chmod(0o555)
    code, _, stderr = call("run", suite, "--out", tmp_path / "run", "--workers", "0")
    (tmp_path / "run").chmod(0o755)
    assert code == 1
    assert "writable" in stderr
