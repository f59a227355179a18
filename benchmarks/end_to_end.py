"""The command line as users run it: episodes per second, and the time to start.

Whole processes are timed from outside. Episodes per second include the start. The time of the
first compilation is the difference of a first and a second short run.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

SEEDS = 1000
COMMAND = [str(Path(sys.executable).with_name("benchnav"))]


def measure() -> list[dict[str, object]]:
    """Return rows: episodes per second with `orca`, time of `--help`, and first compilation."""
    with tempfile.TemporaryDirectory() as folder:
        fresh = {**os.environ, "XDG_CACHE_HOME": str(Path(folder) / "cache")}
        first = seconds(run(2, Path(folder) / "first"), fresh)
        again = seconds(run(2, Path(folder) / "again"), fresh)
        long = min(seconds(run(SEEDS, Path(folder) / f"long{k}"), fresh) for k in range(2))
    help_ = min(seconds(["--help"], dict(os.environ)) for _ in range(5))
    return [
        row("orca, leaders/dynamic, benchnav run, start included", SEEDS / long, "episodes/s", 100),
        row("benchnav --help", help_, "s", 0.4, less=True),
        row("first run of a fresh install: compiling", first - again, "s", 30, less=True),
    ]


def run(seeds: int, out: Path) -> list[str]:
    """Return the arguments of a run of `orca` in `leaders/dynamic`."""
    return [
        "run", "quick", "--scenario", "leaders/dynamic", "--navigator", "orca",
        "--seeds", str(seeds), "--out", str(out), "--quiet",
    ]  # fmt: skip


def seconds(arguments: list[str], environment: dict[str, str]) -> float:
    """Return the wall-clock time [s] of one process."""
    began = perf_counter()
    subprocess.run([*COMMAND, *arguments], env=environment, check=True, capture_output=True)
    return perf_counter() - began


def row(name: str, value: float, unit: str, wanted: float, less: bool = False) -> dict[str, object]:
    """Return one row; its ratio is at least 1 if ``wanted`` is reached."""
    ratio = wanted / value if less else value / wanted
    return {"name": name, "value": value, "unit": unit, "wanted": wanted, "ratio": ratio}


if __name__ == "__main__":
    print(measure())
