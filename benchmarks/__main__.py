"""All measurements: ``python -m benchmarks --peers PYTHON [--check | --out FILE]``."""

import argparse
import sys
from pathlib import Path

from benchmarks import (
    dynamics,
    end_to_end,
    isolation,
    leader_arena,
    noise,
    orca_peers,
    planning,
    training,
)
from benchmarks.check import failures, report
from benchmarks.pair import Pair, measured
from benchmarks.table import KEPT, keep, kept, page


def main() -> None:
    """Measure; print the table and keep it, or compare with the kept ratios."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--peers", default=sys.executable, help="interpreter that has the peers")
    parser.add_argument("--only", default="", help="measure rows whose names contain this text")
    parser.add_argument("--check", action="store_true", help="compare with the kept ratios")
    parser.add_argument("--out", type=Path, help="Markdown file to write the table to")
    arguments = parser.parse_args()
    if arguments.only and arguments.out:
        parser.error("a table holds all rows, so --out cannot be given with --only")
    if arguments.check and not KEPT.exists():
        sys.exit(f"{KEPT} must hold the ratios to compare with. `make bench` writes it.")
    before = kept() if arguments.check else {}
    rows = []
    for pair in pairs(arguments.peers):
        if arguments.only in pair.name:
            rows.append(measured(pair))
            print(report(rows[-1], before.get(pair.name)), file=sys.stderr, flush=True)
    if arguments.check:
        sys.exit("\n".join(failures(rows, before)) or 0)
    text = page(rows)
    print(text)
    if missing := [f"{row.pair.name}: {row.note}" for row in rows if row.note]:
        sys.exit("\n".join(["Not measured, so no table was kept:", *missing]))
    if arguments.out:
        arguments.out.write_text(text, encoding="utf-8")
        keep(rows)


def pairs(peers: str) -> list[Pair]:
    """Return all benchmarks; ``peers`` is an interpreter that has the peers."""
    return [
        *orca_peers.pairs(peers), *leader_arena.pairs(), *dynamics.pairs(), *noise.pairs(),
        *end_to_end.pairs(), *isolation.pairs(), *planning.pairs(),
        *training.pairs(),
    ]  # fmt: skip


if __name__ == "__main__":
    main()
