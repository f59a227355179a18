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
    """Measure each scenario, print a line of it, and keep all numbers if a file is given."""
    parser = argparse.ArgumentParser(
        description=studies.full_knowledge.__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--scenario", action="append", required=True, help="may be given again")
    parser.add_argument("--seeds", type=parse_seeds, default="0:500", help="N or A:B")
    parser.add_argument("--split", choices=SPLITS, default="test")
    parser.add_argument("--out", type=Path, help="JSON file that keeps the numbers")
    options = parser.parse_args()
    found = []
    for scenario in options.scenario:
        try:
            outcomes = measure(scenario, options.split, options.seeds)
        except BenchnavError as error:
            parser.error(str(error))
        found.append(summary(scenario, options.split, outcomes))
        print(found[-1], flush=True)
        if options.out:
            options.out.write_text(json.dumps([asdict(row) for row in found], indent=2) + "\n")


if __name__ == "__main__":
    main()
