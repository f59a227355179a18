"""`make setup` says what it does; pip is heard only where it fails."""

import os
import pty
import subprocess
import sys
from pathlib import Path

STEP = [sys.executable, str(Path(__file__).parents[2] / ".ci" / "step.py"), "Installing it"]
LOUD = [sys.executable, "-c", "print('Collecting numpy'); print('WARNING: old')"]
FAILS = [*LOUD[:2], LOUD[2] + "; raise SystemExit(3)"]


def test_a_step_says_what_it_does_and_how_long_it_took():
    done = subprocess.run([*STEP, *LOUD], capture_output=True, text=True)
    first, last = done.stdout.splitlines()
    assert first == "Installing it …"
    assert last.startswith("Installing it: ")
    assert last.endswith(" s")
    assert (done.returncode, done.stderr) == (0, "")


def test_a_step_that_fails_says_all():
    done = subprocess.run([*STEP, *FAILS], capture_output=True, text=True)
    assert done.stdout.endswith("Installing it: failed\n")
    assert done.stderr == "Collecting numpy\nWARNING: old\n"
    assert done.returncode == 3


def test_a_terminal_shows_what_it_does_now():
    reading, writing = pty.openpty()
    slow = [*LOUD[:2], LOUD[2] + "; import sys, time; sys.stdout.flush(); time.sleep(4)"]
    subprocess.run([*STEP, *slow], stdout=writing, check=True)
    os.close(writing)
    text = os.read(reading, 10_000).decode()
    os.close(reading)
    assert "s  Collecting numpy" in text
    assert "WARNING" not in text
    assert text.count("\n") == 1
