"""Every module can be imported where os.fork, fcntl and the like are missing; commands say so."""

import os
import subprocess
import sys

import pytest

ABSENT = """\
import os, signal, sys
for name in ("fcntl", "grp", "pwd", "resource", "termios"):
    sys.modules[name] = None
for name in ("fork", "forkpty", "getuid", "killpg", "sched_getaffinity", "setsid", "sysconf"):
    vars(os).pop(name, None)
for name in ("SIGALRM", "SIGCHLD", "SIGHUP", "SIGKILL", "SIGUSR1", "pthread_sigmask"):
    vars(signal).pop(name, None)
"""
IMPORT = """\
import pkgutil, importlib, benchnav
for module in pkgutil.walk_packages(benchnav.__path__, "benchnav."):
    importlib.import_module(module.name)
    print(module.name)
"""
COMMAND = "from benchnav.cli.main import main; main()"
FREE = (["--version"], ["schema"], ["--help"])  # of processes
RUN = ["run", "trap/u", "--navigator", "orca", "--seeds", "1", "--out", "run"]
FORKED = (RUN, [*RUN, "--workers", "0"], ["list", "navigators"], ["doctor"])


def python(code, folder, *arguments):
    settings = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "-W", "error", "-c", ABSENT + code, *arguments]
    return subprocess.run(
        command, cwd=folder, env=settings, capture_output=True, text=True, check=False
    )


@pytest.mark.slow
def test_every_module_can_be_imported(tmp_path):
    done = python(IMPORT, tmp_path)
    assert done.stderr == ""
    assert "benchnav.processes.server" in done.stdout.splitlines()


@pytest.mark.slow
@pytest.mark.parametrize("arguments", FREE, ids=" ".join)
def test_commands_that_start_no_process_work(arguments, tmp_path):
    done = python(COMMAND, tmp_path, *arguments)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.slow
@pytest.mark.parametrize("arguments", FORKED, ids=" ".join)
def test_commands_that_start_processes_name_the_cure(arguments, tmp_path):
    done = python(COMMAND, tmp_path, *arguments)
    assert done.returncode == 1
    assert "cannot start processes by os.fork" in done.stderr
    assert "WSL" in done.stderr
    assert "Traceback" not in done.stderr
