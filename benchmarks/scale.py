"""The cost of a thousand navigators × scenarios × seeds: ``python -m benchmarks.scale``.

Every cell of a suite is run in this process on one thread, first with few seeds to warm caches
and then in full. For each navigator, the processor time (which hardly depends on the load of the
machine) and the bytes of the run folder are measured. Prices are arguments.
"""

import argparse
import os
import platform
import statistics
import tempfile
from dataclasses import dataclass
from pathlib import Path
from time import process_time

for name in ("BENCHNAV", "NUMBA_NUM", "OMP_NUM", "OPENBLAS_NUM", "MKL_NUM"):
    os.environ[f"{name}_THREADS"] = "1"  # before any import reads it

from benchnav.runner.plan.suite import Selection, load_suite  # noqa: E402
from benchnav.runner.run import run_suite  # noqa: E402

EPISODES = 1e9
HOURS = 3600.0


@dataclass(frozen=True)
class Cost:
    """The cost of one navigator, mean over scenarios."""

    navigator: str
    seconds: float  # of one core for an episode: drawing, running, measuring, storing
    bytes: float  # of an episode on disk


def measure(suite: str, seeds: int) -> list[Cost]:
    """Run the suite, and return the cost of each navigator."""
    costs = []
    whole = load_suite(suite)
    for contestant in whole.contestants:
        seconds, sizes = [], []
        for scenario in whole.scenarios:
            with tempfile.TemporaryDirectory() as folder:
                for name, count in (("warm", 2), ("run", seeds)):
                    chosen = Selection(
                        (scenario.identity,), ("known",), (contestant.label,), f"{count}"
                    )
                    began = process_time()
                    summary = run_suite(load_suite(suite, chosen), Path(folder, name), workers=0)
                if summary.stored:
                    seconds.append((process_time() - began) / summary.stored)
                    sizes.append(size(Path(folder, "run", "parts")) / summary.stored)
        costs.append(Cost(contestant.label, statistics.mean(seconds), statistics.mean(sizes)))
        cost = costs[-1]
        print(f"{cost.navigator}: {cost.seconds:.4f} s, {cost.bytes:.0f} bytes", flush=True)
    return costs


def size(folder: Path) -> int:
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


def processor() -> str:
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.processor()


def main() -> None:
    """Measure, and print the projected cost."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--suite", default="quick")
    parser.add_argument("--seeds", type=int, default=64)
    parser.add_argument("--core-hour", type=float, default=0.0408, help="[$]")
    parser.add_argument("--gb-month", type=float, default=0.0186, help="[$]")
    arguments = parser.parse_args()
    costs = measure(arguments.suite, arguments.seeds)
    mean = Cost(
        "all alike", statistics.mean(c.seconds for c in costs),
        statistics.mean(c.bytes for c in costs),
    )  # fmt: skip
    print(f"\n{arguments.suite}, {arguments.seeds} seeds a cell, one thread of {processor()}\n")
    print("| navigator | core-seconds | kB | core-years | TB | computing | storing, a month |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: |")
    for cost in (*costs, mean):
        hours = cost.seconds * EPISODES / HOURS
        terabytes = cost.bytes * EPISODES / 1e12
        print(
            f"| {cost.navigator} | {cost.seconds:.4f} | {cost.bytes / 1e3:.1f}"
            f" | {hours / 8766:.1f} | {terabytes:.1f} | ${hours * arguments.core_hour:,.0f}"
            f" | ${terabytes * 1e3 * arguments.gb_month:,.0f} |"
        )


if __name__ == "__main__":
    main()
