"""``module:Class`` in the folder where the command is started: here, in workers, isolated."""

import os
import subprocess
import sys

import pytest

MODULE = """
from benchnav_baselines.navigators.straight_line import StraightLine
from neighbour_of_mine import SPEED


class Mine(StraightLine):
    speed = SPEED
"""
CODE = "import sys; sys.path.remove(''); from benchnav.cli.main import main; main()"


@pytest.mark.long
@pytest.mark.parametrize("more", [("--workers", "0"), ("--workers", "1"), ("--isolate",)])
def test_a_navigator_of_this_folder_runs(suite, more):
    (suite.parent / "navigator_of_mine.py").write_text(MODULE)
    (suite.parent / "neighbour_of_mine.py").write_text("SPEED = 1\n")
    (suite.parent / "random.py").write_text("raise RuntimeError('this is not the standard one')\n")
    navigators = (
        "navigator_of_mine:Mine",
        "{type: hierarchical, planner: grid.astar, controller: orca, label: other}",
    )
    done = subprocess.run(
        [sys.executable, "-c", CODE, "run", suite.name, "--out", "r", "--track", "known",
         *(text for name in navigators for text in ("--navigator", name)), *more],
        cwd=suite.parent, capture_output=True, text=True, check=False, env=dict(os.environ),
    )  # fmt: skip
    assert (done.returncode, done.stdout) == (0, "r\n"), done.stderr
    assert "failed" not in done.stderr
    assert "4 episodes stored" in done.stderr
