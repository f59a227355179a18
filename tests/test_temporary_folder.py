"""Temporary folders go with their process, and with the next one where it was killed."""

import os
import signal
import subprocess
import sys
import tempfile

import pytest

from benchnav.system import temporary_folder
from benchnav.system.temporary_folder import TemporaryFolder, drop_abandoned

MAKES = """
import sys
from benchnav.system.temporary_folder import TemporaryFolder
folder = TemporaryFolder("test")
(folder.path / "big").write_text("x")
print(folder.path, flush=True)
sys.stdin.read()
"""


@pytest.fixture
def root(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    temporary_folder._drop_once.cache_clear()
    return tmp_path


@pytest.fixture
def other(root):
    """Another process with a folder of its own; it ends when it is told."""
    process = subprocess.Popen(
        [sys.executable, "-c", MAKES], env={**os.environ, "TMPDIR": str(root)}, text=True,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE,
    )  # fmt: skip
    path = root / process.stdout.readline().strip()
    assert path.is_dir()
    yield process, path
    process.kill()
    process.communicate()


def test_it_goes_at_the_end_of_its_block(root):
    with TemporaryFolder("test") as folder:
        (folder.path / "inside").mkdir()
        assert folder.path.parent == root
        assert folder.path.stat().st_mode & 0o777 == 0o700
    assert list(root.iterdir()) == []
    folder.remove()


def test_what_another_process_uses_stays_and_goes_once_that_was_killed(root, other):
    process, path = other
    with TemporaryFolder("test"):
        assert (path / "big").exists()
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert path.exists()
    temporary_folder._drop_once.cache_clear()
    with TemporaryFolder("other") as folder:
        assert list(root.iterdir()) == [folder.path]


def test_nothing_else_is_removed(root):
    kept = root / "kept"
    kept.mkdir()
    (kept / "file").write_text("x")
    (root / "benchnav-temporary-link").symlink_to(kept)
    (root / "benchnav-temporary-file").write_text("x")
    (root / f"benchnav-{os.geteuid()}").mkdir()  # the user's private folder
    (root / "benchnav-pack-x").mkdir()  # of another version, which locks nothing
    before = sorted(root.rglob("*"))
    drop_abandoned()
    assert sorted(root.rglob("*")) == before


def test_many_processes_at_once_never_take_each_others(root):
    code = (
        "from benchnav.system.temporary_folder import TemporaryFolder, drop_abandoned\n"
        "for k in range(100):\n"
        "    drop_abandoned()\n"
        "    with TemporaryFolder('test') as folder:\n"
        "        (folder.path / 'x').write_text('x')\n"
        "        assert (folder.path / 'x').read_text() == 'x'\n"
    )
    environment = {**os.environ, "TMPDIR": str(root)}
    processes = [subprocess.Popen([sys.executable, "-c", code], env=environment) for _ in range(4)]
    assert [process.wait() for process in processes] == [0] * 4
    assert list(root.iterdir()) == []
