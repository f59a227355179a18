"""What a process started counts as its own, in memory and in the end."""

import os
import subprocess
import sys
import time

import pytest

from benchnav.processes import process_tree
from benchnav.processes.process_tree import kill, memory_is_known, resident, tree

HOLD = "import time; kept = bytearray(b'x') * 300_000_000; print('held', flush=True); {more}"
LEAF = HOLD.format(more="time.sleep(600)")
BRANCH = (
    "import subprocess, sys, time;"
    f"child = subprocess.Popen([sys.executable, '-c', {LEAF!r}]); time.sleep(600)"
)

linux = pytest.mark.skipif(not memory_is_known(), reason="the system does not tell memory")


@pytest.fixture
def branch():
    """A process that holds little, and has a child that holds 300 MB."""
    process = subprocess.Popen([sys.executable, "-c", BRANCH], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "held\n"
    yield process
    kill(process.pid)
    process.wait()
    process.stdout.close()


def alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return not (process_tree.PROC / f"{pid}/stat").read_text().split(") ")[1].startswith("Z")


@linux
def test_memory_and_end_are_those_of_the_tree(branch):
    assert branch.pid in tree(os.getpid())
    parent, child = tree(branch.pid)
    assert parent == branch.pid
    assert 300e6 < resident(branch.pid) < 500e6
    assert resident(os.getpid()) > resident(branch.pid)
    kill(branch.pid)
    branch.wait()
    deadline = time.monotonic() + 10
    while alive(child) and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not alive(child)
    assert resident(branch.pid) == 0


def test_where_the_system_tells_nothing_a_process_is_alone(monkeypatch, tmp_path):
    monkeypatch.setattr(process_tree, "PROC", tmp_path / "none")
    assert tree(os.getpid()) == [os.getpid()]
    assert resident(os.getpid()) == 0
    assert not memory_is_known()
