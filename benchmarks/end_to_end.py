"""The command line as users run it: episodes per second, the time to start, and to compile.

Whole processes are timed from outside, start included. Every episode is measured by all metrics
and stored, by one worker for each core. ``compiling`` is a run of two episodes without compiled
kernels.
"""

import os
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path
from time import perf_counter

from benchmarks.pair import Pair

EPISODE = (
    "The largest parts of an episode are its metrics, sensing and the drawing of its world; storing"
    " and reading it, steps and the guard of benchnav's code share the rest."
)
QUICK = (
    "Half of the time are the learned navigators and q-learning-grid, which learns in each world."
)
COMPILING = "Numba and LLVM compile some 270 functions; two processes share them."
COMMAND = [str(Path(sys.executable).with_name("benchnav"))]
LONG, SHORT = 20_000, 2_000  # seeds
WANTED = {"orca": (450.0, 650.0), "straight-line": (500.0, 800.0)}  # episodes per second


def pairs() -> list[Pair]:
    """Return rates of episodes, and times of whole commands."""
    rates = [
        Pair(
            name=f"{navigator}, leaders/dynamic, {seeds:,} seeds, start included",
            ours=partial(rate, navigator, seeds), wanted=wanted, unit="episodes/s",
            blocks=1 if seeds == LONG else 2, warm=seeds == SHORT, limit=EPISODE,
        )
        for navigator, both in WANTED.items()
        for seeds, wanted in zip((SHORT, LONG), both, strict=True)
    ]  # fmt: skip
    return [
        *rates,
        Pair(name="run quick, warm", ours=quick, wanted=12.0, unit="s", blocks=2, limit=QUICK),
        Pair(name="two episodes of orca, warm", ours=start, wanted=1.0, unit="s"),
        Pair(name="benchnav --help", ours=partial(whole, "--help"), wanted=0.4, unit="s"),
        Pair(
            name="first run: compiling",
            ours=first,
            wanted=15.0,
            unit="s",
            blocks=1,
            warm=False,
            limit=COMPILING,
        ),
    ]


def rate(navigator: str, seeds: int) -> float:
    """Return episodes per second of a whole run in `leaders/dynamic`."""
    with tempfile.TemporaryDirectory() as folder:
        return seeds * whole(*arguments(navigator, seeds, folder))


def start() -> float:
    """Return how often a second a run of two episodes can be done."""
    with tempfile.TemporaryDirectory() as folder:
        return whole(*arguments("orca", 2, folder), "--workers", "1")


def quick() -> float:
    """Return how often a second the suite `quick` can be run."""
    with tempfile.TemporaryDirectory() as folder:
        return whole("run", "quick", "--out", f"{folder}/run", "--quiet")


def first() -> float:
    """Return how often a second a first run, which compiles, can be done."""
    with tempfile.TemporaryDirectory() as folder:
        return whole(*arguments("orca", 2, folder), cache=f"{folder}/cache")


def arguments(navigator: str, seeds: int, folder: str) -> list[str]:
    """Return the arguments of a run in `leaders/dynamic`."""
    return [
        "run", "leaders/dynamic", "--navigator", navigator, "--seeds", str(seeds),
        "--out", f"{folder}/run", "--quiet",
    ]  # fmt: skip


def whole(*words: str, cache: str = "") -> float:
    """Return how often a second a command can be done, from one whole process."""
    environment = {**os.environ, **({"XDG_CACHE_HOME": cache} if cache else {})}
    began = perf_counter()
    subprocess.run([*COMMAND, *words], env=environment, check=True, capture_output=True)
    return 1.0 / (perf_counter() - began)
