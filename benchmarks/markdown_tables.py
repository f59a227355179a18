"""The command line of studies that print Markdown tables, part by part."""

import argparse
from collections.abc import Callable, Iterable, Mapping, Sequence

Rows = Callable[[int], Iterable[Sequence[str]]]
"""Number of simulated tables → the rows of a part, its heading first."""


def print_parts(description: str, parts: Mapping[str, Rows], tables: int) -> None:
    """Print the parts on the command line, or all; ``tables`` is the default number of tables."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--tables", type=int, default=tables)
    parser.add_argument("--part", choices=parts, action="append", help="repeatable")
    arguments = parser.parse_args()
    for part in arguments.part or parts:
        print(f"\n{part}\n")
        for k, row in enumerate(parts[part](arguments.tables)):
            print(f"| {' | '.join(row)} |", flush=True)
            if k == 0:
                print("| --- |" + " --- |" * (len(row) - 1))
