"""Worlds of shipped scenarios stay as they are; a change of theirs needs a new version.

`python -m tests.world.test_golden_worlds` writes the file anew.
"""

import hashlib
import json
from pathlib import Path

import numpy as np
import pytest

from benchnav.generation.build import build
from benchnav.scenario.load import load_scenario
from tests.scenario.files import SHIPPED

GOLDEN = Path(__file__).with_name("golden_worlds.json")


def fingerprint(world):
    """Of everything that was drawn, to the nanometre."""
    parts = [world.agents.start, world.agents.goal, world.agents.preferred_speed]
    parts += [solid.capsules for solid in world.solids]
    parts += [array for body in world.bodies for array in (body.law.times, body.law.points)]
    digest = hashlib.sha256()
    for part in parts:
        digest.update((np.round(part, 9) + 0.0).tobytes())
    return digest.hexdigest()[:16]


def fingerprints(path):
    scenario = load_scenario(path)
    worlds = [build(scenario, split, seed) for split in ("train", "test") for seed in (0, 1)]
    return scenario.identity, [fingerprint(world) for world in worlds]


@pytest.mark.parametrize("path", SHIPPED, ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_worlds_are_what_they_were(path):
    identity, found = fingerprints(path)
    assert json.loads(GOLDEN.read_text())[identity] == found


if __name__ == "__main__":
    GOLDEN.write_text(json.dumps(dict(map(fingerprints, SHIPPED)), indent=1) + "\n")
