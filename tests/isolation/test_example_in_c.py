"""The example in C is compiled and run, and is better than going straight at the goal."""

import shutil
import subprocess
from pathlib import Path

import pytest

from benchnav.generation.build import build
from benchnav.metrics.success import success
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import NAVIGATORS
from benchnav.runner.rollouts.rollout import Assignment, rollout
from benchnav.scenario.catalogue import find
from benchnav.testing.check_navigator import check_navigator

SOURCE = Path(__file__).parents[2] / "examples" / "c_navigator" / "seeker.c"
COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")

pytestmark = pytest.mark.skipif(COMPILER is None, reason="no C compiler is installed")


@pytest.fixture(scope="module")
def seeker(tmp_path_factory):
    program = tmp_path_factory.mktemp("c") / "seeker"
    flags = ["-std=c11", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    subprocess.run([COMPILER, *flags, "-o", program, SOURCE, "-lm"], check=True)
    return {"type": "process", "command": [str(program)]}


def test_it_keeps_the_contract(seeker):
    check_navigator(lambda: make(NAVIGATORS, seeker))


def test_it_avoids(seeker):
    scenario = find("leaders/static")
    worlds = [(seed, build(scenario, "test", seed)) for seed in range(10)]
    rates = {}
    for label, spec in (("seeker", seeker), ("straight", "straight-line")):
        assignment = Assignment(
            scenario.identity, scenario.hash, "test", "unknown", label, spec,
            scenario.driver_specs, salt="00",
        )  # fmt: skip
        episodes = [e for batch in rollout(assignment, worlds) for e in batch]
        assert {e.failure for e in episodes} == {""}
        rates[label] = sum(float(success(e).mean()) for e in episodes) / len(episodes)
    assert rates["seeker"] > rates["straight"] + 0.2
