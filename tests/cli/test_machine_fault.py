"""What the machine refuses is told in a sentence, with the cure and without a traceback."""

import errno
import os
import resource
import subprocess
import sys

import pytest

from benchnav.cli import main

FAULTS = [
    (OSError(errno.EMFILE, "Too many open files"), "Too many open files. Allow this process more"),
    (BlockingIOError(errno.EAGAIN, "Try again"), "Try again. Allow this user more processes"),
    (MemoryError(), "Memory is short. Allow this process more memory (ulimit -v)"),
    (RuntimeError("can't start new thread"), "No further thread can be started. Allow this user"),
    (
        ImportError("libx.so: failed to map segment"),
        "libx.so: failed to map segment. Allow this process",
    ),
    (FileNotFoundError(errno.ENOENT, "No usable temporary directory"), "No usable temporary"),
]


@pytest.mark.parametrize(("error", "sentence"), FAULTS, ids=lambda value: str(value)[:20])
def test_what_the_machine_refuses_is_one_sentence(error, sentence, call, monkeypatch):
    def refuse(*_, **__):
        raise error

    monkeypatch.setattr(main, "app", refuse)
    code, stdout, stderr = call("list")
    assert (code, stdout) == (1, "")
    assert stderr.startswith(f"benchnav: {sentence}")
    assert stderr.count("\n") == 1


def test_other_errors_are_faults_of_the_program(call, monkeypatch):
    def refuse(*_, **__):
        raise RuntimeError("a bug")

    monkeypatch.setattr(main, "app", refuse)
    with pytest.raises(RuntimeError, match="a bug"):
        call("list")


@pytest.mark.slow
@pytest.mark.parametrize("files", [10, 64])
def test_few_descriptors_are_enough_or_told(files, suite, tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", "from benchnav.cli.main import main; main()", "run", str(suite),
         "--navigator", "straight-line", "--out", "run", "--workers", "2", "--quiet"],
        cwd=tmp_path, text=True, capture_output=True, env={**os.environ}, check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (files, files)),
    )  # fmt: skip
    assert "Traceback" not in done.stderr
    if files == 64:
        assert (done.returncode, done.stdout) == (0, "run\n")
    else:
        assert done.returncode == 1
        assert (
            "Too many open files. Allow this process more of them (ulimit -n 1024)" in done.stderr
        )
