"""The command line as its users run it: episodes a second, and how long it takes to start.

Whole processes from outside. Episodes a second is measured as the difference of a
long and a short run, and once with the start included.
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
    """Rows: episodes a second with `orca`, `--help`, the first compilation."""
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
    """Arguments of a run of `orca` in `leaders/dynamic`."""
    return [
        "run", "quick", "--scenario", "leaders/dynamic", "--navigator", "orca",
        "--seeds", str(seeds), "--out", str(out), "--quiet",
    ]  # fmt: skip


def seconds(arguments: list[str], environment: dict[str, str]) -> float:
    """Wall-clock time of one process."""
    began = perf_counter()
    subprocess.run([*COMMAND, *arguments], env=environment, check=True, capture_output=True)
    return perf_counter() - began


def row(name: str, value: float, unit: str, wanted: float, less: bool = False) -> dict[str, object]:
    """One measured figure; its ratio to what is wanted is above 1 where that is reached."""
    ratio = wanted / value if less else value / wanted
    return {"name": name, "value": value, "unit": unit, "wanted": wanted, "ratio": ratio}


if __name__ == "__main__":
    print(measure())
