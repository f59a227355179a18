"""All measurements as one table: ``python -m benchmarks --peers PYTHON [--out FILE]``."""

import argparse
import platform
import sys
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

from benchmarks import end_to_end, isolation, leader_arena, orca_peers
from benchnav.threads import thread_count

PACKAGES = ("benchnav", "numpy", "numba", "shapely", "pyarrow")


def main() -> None:
    """Measure and print the table, and write it to ``--out`` if all rows were measured."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--peers", required=True, help="interpreter that has pyrvo and navground")
    parser.add_argument("--out", type=Path, help="Markdown file to write the table to")
    arguments = parser.parse_args()
    rows = orca_peers.measure(arguments.peers)
    rows += leader_arena.measure() + end_to_end.measure() + isolation.measure()
    text = page(rows)
    print(text)
    if missing := [f"{row['name']}: {row['note']}" for row in rows if "note" in row]:
        sys.exit("\n".join(["Not measured, so no table was kept:", *missing]))
    if arguments.out:
        arguments.out.write_text(text)


def page(rows: list[dict[str, object]]) -> str:
    """Return the table, with machine and versions."""
    versions = ", ".join(f"{name} {version(name)}" for name in PACKAGES)
    lines = [
        "# Benchmarks",
        "",
        f"Measured {datetime.now(UTC):%Y-%m-%d} with `make bench` on {platform.machine()},"
        f" {thread_count()} cores, {platform.system()}, Python {platform.python_version()};"
        f" {versions}.",
        "benchnav and its peers (other simulators) are measured in the same run. The docstring of"
        " each file in `benchmarks/` describes the timed part.",
        "",
        "| benchmark | measured | peer | target | reached |",
        "| --- | ---: | ---: | ---: | --- |",
    ]
    return "\n".join([*lines, *map(line, rows), ""])


def line(row: dict[str, object]) -> str:
    """Return one row of the table."""
    if "note" in row:
        return f"| {row['name']} | – | – | – | {row['note']} |"
    value, ratio, wanted = (float(str(row[key])) for key in ("value", "ratio", "wanted"))
    against, goal, enough = "–", f"{number(wanted)} {row['unit']}", 1.0
    if "peer" in row:
        against = f"{number(float(str(row['peer'])))}: {ratio:.1f} ×"
        goal, enough = f"{wanted:g} ×", wanted
    reached = "yes" if ratio >= enough else "no"
    return f"| {row['name']} | {number(value)} {row['unit']} | {against} | {goal} | {reached} |"


def number(value: float) -> str:
    """Return a number with three significant digits, with M for millions."""
    return f"{value / 1e6:.2f} M" if value >= 1e5 else f"{value:.3g}"


if __name__ == "__main__":
    main()
