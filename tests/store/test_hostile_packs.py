"""Packs from anybody are read, or refused in one sentence, in seconds and within a gigabyte."""

import subprocess
import sys
from pathlib import Path

import pytest

from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.run import run_suite
from tests.store import hostile


@pytest.fixture(scope="module")
def real(tmp_path_factory):
    """A run that can be verified."""
    out = tmp_path_factory.mktemp("real") / "run"
    chosen = Selection(navigators=("straight-line", "random-walk"), seeds="2")
    run_suite(load_suite("leaders/static", chosen), out, workers=0)
    return out


def tried(run, times, seed=0):
    """What the program says of so many packs."""
    done = subprocess.run(
        [sys.executable, hostile.__file__, str(run), str(times), str(seed)],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-2000:]


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory is watched in /proc")
def test_changed_packs_are_read_or_refused(real):
    tried(real, 60)


@pytest.mark.soak
@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory is watched in /proc")
def test_thousands_of_changed_packs_are_read_or_refused(real):
    tried(real, 2000, 1000)
