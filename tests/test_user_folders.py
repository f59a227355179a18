"""Where caches and receipts are kept: of users without a home, without a name, and of others."""

import os
import pwd
import subprocess
import sys
import tempfile

import pytest

from benchnav.system.user_folders import user_cache, user_state

USER = os.geteuid()


@pytest.fixture(autouse=True)
def machine(monkeypatch, tmp_path):
    """Temporary files of this test alone, and nothing that names a folder."""
    for name in ("HOME", "XDG_CACHE_HOME", "XDG_STATE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "tmp"))
    (tmp_path / "tmp").mkdir()


@pytest.fixture
def private(tmp_path):
    """The folder that takes the place of a home."""
    return tmp_path / "tmp" / f"benchnav-{USER}"


def unknown_user(monkeypatch):
    def fail(uid):
        raise KeyError(f"getpwuid(): uid not found: {uid}")

    monkeypatch.setattr(pwd, "getpwuid", fail)


def test_the_usual_folders_are_below_the_home_or_where_xdg_says(monkeypatch, tmp_path):
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert user_cache().path == tmp_path / "home" / ".cache" / "benchnav"
    assert user_state().path == tmp_path / "home" / ".local" / "state" / "benchnav"
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    assert user_state().path == tmp_path / "state" / "benchnav"
    assert user_cache().reason == user_state().reason == ""


def test_a_user_without_home_and_name_has_a_private_folder(monkeypatch, private):
    unknown_user(monkeypatch)
    found = user_cache()
    assert found.path == private / ".cache" / "benchnav"
    assert found.reason == f"HOME is not set and user {USER} has no home"
    assert private.stat().st_mode & 0o777 == 0o700
    assert user_state().path == private / ".local" / "state" / "benchnav"


@pytest.mark.parametrize("home", ["/dev/null", "/proc/none", "relative", "/dev/null/below"])
def test_a_home_that_cannot_be_used_is_replaced(monkeypatch, private, home):
    monkeypatch.setenv("HOME", home)
    found = user_cache()
    assert found.path == private / ".cache" / "benchnav"
    assert home in found.reason


def test_a_relative_xdg_folder_is_ignored(monkeypatch, tmp_path):
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    assert user_cache().path == tmp_path / "home" / ".cache" / "benchnav"


@pytest.mark.skipif(USER != 0, reason="only root can give a folder to another user")
def test_the_home_of_another_user_is_left_alone(monkeypatch, tmp_path, private):
    home = tmp_path / "home"
    home.mkdir()
    os.chown(home, 12345, 12345)
    monkeypatch.setenv("HOME", str(home))
    found = user_cache()
    assert found.path == private / ".cache" / "benchnav"
    assert found.reason == f"{home} cannot be used: it belongs to another user (12345)"
    assert list(home.iterdir()) == []


@pytest.mark.skipif(USER == 0, reason="root may write everywhere")
def test_a_home_that_is_read_only_is_replaced(monkeypatch, tmp_path, private):
    home = tmp_path / "home"
    home.mkdir(mode=0o500)
    monkeypatch.setenv("HOME", str(home))
    assert user_cache().path == private / ".cache" / "benchnav"
    home.chmod(0)  # not even to be looked into
    assert user_cache().path == private / ".cache" / "benchnav"


def test_a_folder_that_every_user_can_write_is_not_used(monkeypatch, tmp_path, private):
    (tmp_path / "shared" / "benchnav").mkdir(parents=True)
    (tmp_path / "shared" / "benchnav").chmod(0o777)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "shared"))
    found = user_cache()
    assert found.path == private / ".cache" / "benchnav"
    assert "every user can write it" in found.reason


def test_a_folder_that_was_planted_among_the_temporary_files_is_not_used(
    monkeypatch, tmp_path, private
):
    unknown_user(monkeypatch)
    (tmp_path / "elsewhere").mkdir()
    private.symlink_to(tmp_path / "elsewhere")
    found = user_cache()
    assert found.path is None
    assert "must be a folder, not a link" in found.reason
    private.unlink()
    if USER == 0:
        private.mkdir()
        os.chown(private, 12345, 12345)
        assert user_cache().path is None
        private.rmdir()
    private.write_text("a file")
    assert user_cache().path is None


def test_a_private_folder_is_closed_to_others(monkeypatch, private):
    unknown_user(monkeypatch)
    private.mkdir()
    private.chmod(0o777)
    assert user_cache().path is not None
    assert private.stat().st_mode & 0o777 == 0o700


KERNEL = """
from benchnav.kernels import cache_base, kernel
@kernel
def double(x):
    return 2 * x
print(double(2), cache_base().path, cache_base().reason, sep="|")
"""


def compiled(tmp_path, **environment):
    (tmp_path / "one_kernel.py").write_text(KERNEL)
    done = subprocess.run(
        [sys.executable, "one_kernel.py"], cwd=tmp_path, text=True, capture_output=True, check=True,
        env={"PATH": os.environ["PATH"], "HOME": "/dev/null", **environment},
    )  # fmt: skip
    return done.stdout.strip().split("|")


@pytest.mark.slow
def test_kernels_compile_where_nothing_can_be_kept(tmp_path, private):
    private.write_text("not a folder")
    found = compiled(tmp_path, TMPDIR=str(private.parent))
    assert found[:2] == ["4", "None"]


@pytest.mark.slow
def test_numba_cache_dir_is_used_and_one_that_cannot_be_is_replaced(tmp_path, private):
    named = compiled(tmp_path, TMPDIR=str(private.parent), NUMBA_CACHE_DIR=str(tmp_path / "n"))
    assert named == ["4", str(tmp_path / "n"), ""]
    assert list((tmp_path / "n").glob("kernels-*/*.kernel"))
    _, path, reason = compiled(tmp_path, TMPDIR=str(private.parent), NUMBA_CACHE_DIR="/dev/null/x")
    assert path == str(private / ".cache" / "benchnav")
    assert reason == "NUMBA_CACHE_DIR=/dev/null/x cannot be used (Not a directory)"
