"""The command line of studies that print Markdown tables, part by part."""

import argparse
from collections.abc import Callable, Iterable, Mapping, Sequence

Rows = Callable[[int], Iterable[Sequence[str]]]
"""How many tables are simulated → the rows of a part, its heading first."""


def print_parts(description: str, parts: Mapping[str, Rows], tables: int) -> None:
    """Print the parts that the command line names, or all; ``tables`` are simulated unless told."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--tables", type=int, default=tables)
    parser.add_argument("--part", choices=parts, action="append", help="may be given again")
    asked = parser.parse_args()
    for part in asked.part or parts:
        print(f"\n{part}\n")
        for k, row in enumerate(parts[part](asked.tables)):
            print(f"| {' | '.join(row)} |", flush=True)
            if k == 0:
                print("| --- |" + " --- |" * (len(row) - 1))
