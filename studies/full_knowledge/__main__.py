"""``python -m studies.full_knowledge --scenario leaders/dynamic --seeds 0:500``."""

import argparse
import json
from dataclasses import asdict
from pathlib import Path

import studies.full_knowledge
from benchnav.errors import BenchnavError
from benchnav.runner.plan.suite_file import parse_seeds
from benchnav.scenario.terms import SPLITS

from .measure import measure, summary


def main() -> None:
    """Measure each scenario, print a line of it, and keep all numbers where asked."""
    parser = argparse.ArgumentParser(
        description=studies.full_knowledge.__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--scenario", action="append", required=True, help="may be given again")
    parser.add_argument("--seeds", type=parse_seeds, default="0:500", help="N or A:B")
    parser.add_argument("--split", choices=SPLITS, default="test")
    parser.add_argument("--out", type=Path, help="JSON file that keeps the numbers")
    asked = parser.parse_args()
    found = []
    for scenario in asked.scenario:
        try:
            outcomes = measure(scenario, asked.split, asked.seeds)
        except BenchnavError as error:
            parser.error(str(error))
        found.append(summary(scenario, asked.split, outcomes))
        print(found[-1], flush=True)
        if asked.out:
            asked.out.write_text(json.dumps([asdict(row) for row in found], indent=2) + "\n")


if __name__ == "__main__":
    main()
