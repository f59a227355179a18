"""`python -m benchnav` is the command, and a shell completes its verbs."""

import os
import subprocess
import sys
from pathlib import Path

import benchnav


def output(*command, **environment):
    done = subprocess.run(
        command, capture_output=True, text=True, check=True, env={**os.environ, **environment}
    )
    return done.stdout


def test_the_module_is_the_command():
    shown = output(sys.executable, "-m", "benchnav", "--version")
    assert shown.splitlines()[0] == benchnav.__version__


def test_a_shell_completes_verbs():
    script = Path(sys.executable).with_name("benchnav")
    words = {"COMP_WORDS": "benchnav lea", "COMP_CWORD": "1"}
    assert output(script, _BENCHNAV_COMPLETE="complete_bash", **words).split() == ["leaderboard"]
