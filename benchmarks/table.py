"""The page of benchmarks, and the ratios that are kept beside it for comparison."""

import json
import platform
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

from benchmarks.pair import Row, number
from benchnav.threads import thread_count

KEPT = Path(__file__).with_name("kept_ratios.json")
PACKAGES = ("benchnav", "numpy", "numba", "shapely", "pyarrow")
YARDSTICK = "yardstick"


def page(rows: Sequence[Row]) -> str:
    """Return the table, with machine and versions."""
    versions = ", ".join(f"{name} {version(name)}" for name in PACKAGES)
    lines = [
        "# Benchmarks",
        "",
        f"Measured {datetime.now(UTC):%Y-%m-%d} with `make bench` on {processor()},"
        f" {thread_count()} cores, {platform.system()}, Python {platform.python_version()};"
        f" {versions}.",
        "Both sides of a row are measured in turns in the same run; brackets hold the 95 % interval"
        " of their ratio. The docstring of each file in `benchmarks/` describes the timed part."
        " Rows without a peer (another simulator) are compared with a yardstick, fixed work in"
        " Python and numpy; `benchmarks/kept_ratios.json` holds all ratios. `make bench-check`"
        " measures again, and fails if a ratio is more than 10 % below the kept one.",
        "",
        "| benchmark | measured | compared with | ratio | target | reached |",
        "| --- | ---: | --- | ---: | ---: | --- |",
        *map(line, rows),
        "",
        *limits(rows),
    ]
    return "\n".join(lines)


def line(row: Row) -> str:
    """Return one row of the table."""
    pair = row.pair
    if row.note:
        return f"| {pair.name} | – | – | – | – | {row.note} |"
    goal = f"{pair.wanted:.2g} ×" if pair.peer else f"{number(pair.wanted)} {pair.unit}"
    cells = (
        pair.name, f"{number(row.value)} {pair.unit}", pair.peer or YARDSTICK,
        row.text if pair.peer else "–", goal, "yes" if row.reached else "no",
    )  # fmt: skip
    return f"| {' | '.join(cells)} |"


def limits(rows: Sequence[Row]) -> Iterator[str]:
    """Yield the limits of the rows that fall short."""
    short = [row.pair for row in rows if not row.note and not row.reached and row.pair.limit]
    if short:
        yield "Limits of the rows that fall short:"
        yield ""
        for limit in dict.fromkeys(pair.limit for pair in short):
            names = "; ".join(pair.name for pair in short if pair.limit == limit)
            yield f"- {limit} *{names}*"
        yield ""


def processor() -> str:
    """Return the name of the processor."""
    facts = Path("/proc/cpuinfo")
    if facts.exists():
        for text in facts.read_text().splitlines():
            if text.startswith("model name"):
                return text.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def keep(rows: Sequence[Row], path: Path = KEPT) -> None:
    """Write the ratios to a file."""
    ratios = {row.pair.name: float(f"{row.ratio:.4g}") for row in rows}
    path.write_text(json.dumps(ratios, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


def kept(path: Path = KEPT) -> dict[str, float]:
    """Return the kept ratios by name of the benchmark."""
    ratios: dict[str, float] = json.loads(path.read_text(encoding="utf-8"))
    return ratios
