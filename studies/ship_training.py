"""``python -m studies.ship_training WEIGHTS NAME``: include a further training of an entry.

Stores the weights that another seed gave as float16 beside those that ship, under the name
``NAME-seed-N``, which suites can list: ``{type: NAME, weights: [NAME, NAME-seed-1]}``.
"""

import argparse
from pathlib import Path

from benchnav_baselines.learned.recurrent_ppo.policy_at_work import SHIPPED, SUFFIX
from benchnav_baselines.learned.recurrent_ppo.weights import read_weights, write_half


def include(weights: Path, name: str, folder: Path = SHIPPED) -> Path:
    """Return the file that was written."""
    seed = read_weights(weights)[1]["progress"]["seed"]
    target = folder / f"{name}-seed-{seed}{SUFFIX}"
    write_half(weights, target)
    return target


def main() -> None:
    """Include the weights and print the file."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("weights", type=Path)
    parser.add_argument("name")
    options = parser.parse_args()
    print(include(options.weights, options.name))


if __name__ == "__main__":
    main()
