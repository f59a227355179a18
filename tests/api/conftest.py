"""A small suite, and a run of it."""

import pytest

import benchnav

TINY = """
name: tiny/open
title: Two discs that change places
parameters:
  size: {default: 0.2, low: 0.1, high: 0.3, description: "of a disc [m]"}
bounds: [-3, -3, 3, 3]
teams:
  - name: pair
    count: 2
    radius: {parameter: size}
    max_speed: 1
    start: {type: circle, radius: 2}
    goal: {type: antipodal}
clock: {dt: 0.2, substeps: 2, horizon: 6}
"""


@pytest.fixture(scope="session")
def scenario_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("scenario") / "open.yaml"
    path.write_text(TINY)
    return path


@pytest.fixture(scope="session")
def suite(scenario_file):
    return {
        "name": "tiny", "scenarios": [scenario_file], "seeds": 2, "tracks": ["known", "unknown"],
        "navigators": ["orca", "straight-line"],
    }  # fmt: skip


@pytest.fixture(scope="session")
def run(suite, tmp_path_factory):
    return benchnav.run(suite, out=tmp_path_factory.mktemp("run"), workers=0, quiet=True)


@pytest.fixture(scope="session")
def world(scenario_file):
    return benchnav.load_scenario(scenario_file).world(seed=1)
