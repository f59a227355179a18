"""Compiled kernels on disk: whatever happened to the files, the right code runs."""

import os
import subprocess
import sys
from pathlib import Path

import numba
import pytest

from benchnav.kernel_cache import KernelCache, drop_unfinished


def double(x):
    return 2 * x


def compiled(folder):
    """A new dispatcher of `double`, after a call: as in a new process."""
    dispatcher = numba.njit(double)
    dispatcher._cache = KernelCache(double, folder)
    assert dispatcher(21) == 42
    return dispatcher


def was_loaded(dispatcher):
    return sum(dispatcher.stats.cache_hits.values()) == 1


def flip(path):
    raw = bytearray(path.read_bytes())
    raw[len(raw) // 2] ^= 1
    path.write_bytes(raw)


def become_folder(path):
    path.unlink()
    (path / "inside").mkdir(parents=True)


def become_link_to_nothing(path):
    path.unlink()
    path.symlink_to("nowhere")


DAMAGE = {
    "empty": lambda path: path.write_bytes(b""),
    "cut short": lambda path: path.write_bytes(path.read_bytes()[:-1]),
    "longer": lambda path: path.write_bytes(path.read_bytes() + b"x"),
    "garbage": lambda path: path.write_bytes(os.urandom(1000)),
    "one bit flipped": flip,
    "missing": lambda path: path.unlink(),
    "a folder": become_folder,
    "a link to nothing": become_link_to_nothing,
    "not readable": lambda path: path.chmod(0),
}


@pytest.mark.parametrize("damage", DAMAGE.values(), ids=DAMAGE)
def test_a_damaged_file_is_compiled_again_and_replaced(damage, tmp_path):
    assert not was_loaded(compiled(tmp_path))
    assert was_loaded(compiled(tmp_path))
    (path,) = tmp_path.iterdir()
    damage(path)
    compiled(tmp_path)
    assert was_loaded(compiled(tmp_path))
    assert list(tmp_path.iterdir()) == [path]


def test_a_file_of_another_version_of_numba_is_replaced(tmp_path, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(numba, "__version__", "0.1.0")
        compiled(tmp_path)
    assert not was_loaded(compiled(tmp_path))
    assert was_loaded(compiled(tmp_path))


def test_a_file_of_another_signature_under_this_name_is_replaced(tmp_path):
    dispatcher = compiled(tmp_path)
    (whole,) = tmp_path.iterdir()
    assert dispatcher(1.5) == 3.0
    (other,) = set(tmp_path.iterdir()) - {whole}
    whole.write_bytes(other.read_bytes())
    assert not was_loaded(compiled(tmp_path))


@pytest.mark.parametrize("kind", ["missing", "file", "below a file"])
def test_a_folder_that_is_not_there_is_made_where_it_can_be(kind, tmp_path):
    folder = tmp_path / "a"
    if kind == "file":
        folder.write_text("not a folder")
    if kind == "below a file":
        folder.write_text("not a folder")
        folder /= "b"
    compiled(folder)
    assert was_loaded(compiled(folder)) == (kind != "below a file")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_read_only_folder_is_read(tmp_path):
    compiled(tmp_path)
    tmp_path.chmod(0o500)
    assert was_loaded(compiled(tmp_path))
    (path,) = tmp_path.iterdir()
    flip(path)
    assert not was_loaded(compiled(tmp_path))


def test_a_full_disk_keeps_nothing(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", full)
        assert not was_loaded(compiled(tmp_path))
    assert list(tmp_path.iterdir()) == []


def test_what_a_killed_process_left_is_removed_once_nobody_can_be_writing_it(tmp_path):
    old, new = tmp_path / ".writing-old", tmp_path / ".writing-new"
    for path in (old, new):
        path.write_bytes(b"x")
    os.utime(old, (0, 0))
    drop_unfinished(tmp_path)
    assert list(tmp_path.iterdir()) == [new]


MODULE = """
from benchnav.kernels import kernel
@kernel
def double(x):
    return 2 * x
assert (double(ARGUMENT), double(21)) == (2 * ARGUMENT, 42)
"""


@pytest.mark.slow
def test_processes_that_compile_at_once_leave_what_each_of_them_can_load(tmp_path):
    (tmp_path / "one.py").write_text(MODULE)
    code = "import builtins, sys; builtins.ARGUMENT = eval(sys.argv[1]); import one;"
    code += "print(sum(one.double.for_python.stats.cache_hits.values()))"
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}

    def start(argument):
        return subprocess.Popen(
            [sys.executable, "-c", code, argument], cwd=tmp_path, env=environment, text=True,
            stdout=subprocess.PIPE,
        )  # fmt: skip

    for arguments in (("1.5", "True", "2.5", "1j"), ("1.5", "1j")):
        processes = [start(argument) for argument in arguments]
        hits = [process.communicate()[0].strip() for process in processes]
        assert [process.returncode for process in processes] == [0] * len(arguments)
    assert hits == ["2", "2"]


@pytest.mark.parametrize("prefix", ["", "inner-"])
def test_loaded_code_runs_and_links_into_callers_where_it_may(prefix, tmp_path):
    def new():
        dispatcher = numba.njit(double)
        dispatcher._cache = KernelCache(double, tmp_path, prefix)
        return dispatcher

    assert new()(21) == 42
    loaded = new()
    if prefix:

        @numba.njit
        def twice(x):
            return loaded(loaded(x))

        assert twice(21) == 84
    assert loaded(21) == 42
    assert was_loaded(loaded)
