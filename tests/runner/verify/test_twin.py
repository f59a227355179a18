"""The slow twin agrees with the kernels, and finds what is wrong with them."""

import dataclasses
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from benchnav.arena.world import ContactRule
from benchnav.verify.finding import Report
from benchnav.verify.part_check import PartCheck
from benchnav.verify.reference.reference_check import check_twin
from benchnav.verify.reference.sample import sampled
from tests.runner.verify.faulty import FAULTS, JUDGED, play
from tests.worlds import limited_world, random_world


@pytest.mark.parametrize("contact", list(ContactRule))
@pytest.mark.parametrize("unicycle", [True, False])
def test_it_agrees_with_the_kernels(contact, unicycle):
    report = Report()
    for seed in range(6):
        drawn = random_world(seed, contact=contact, unicycle=unicycle, steps=60)
        check_twin(drawn, play(drawn, seed), f"seed {seed}", report)
    assert report.findings == []
    assert report.counts["twin decisions"] > 50
    assert report.counts["twin events"] > 5
    assert sum(report.notes.values()) < 0.1 * report.counts["twin decisions"]


@pytest.mark.parametrize("contact", list(ContactRule))
def test_it_agrees_with_all_dynamics_and_limits(contact):
    report = Report()
    for seed in range(6):
        drawn = limited_world(seed, contact=contact, steps=60)
        check_twin(drawn, play(drawn, seed), f"seed {seed}", report)
    assert report.findings == []
    assert report.counts["twin decisions"] > 50
    assert sum(report.notes.values()) < 0.1 * report.counts["twin decisions"]


def test_a_crowd_in_a_grid():
    drawn = random_world(0, count=40, radius=0.25, steps=40)
    report = Report()
    check_twin(drawn, play(drawn, 0), "", report)
    assert report.findings == []
    assert report.counts["twin events"] > 20


def test_a_replay_ends_with_its_time_and_says_so():
    drawn = random_world(1, count=20, steps=30)
    episode, report = play(drawn, 1), Report()
    check_twin(drawn, episode, "", report, seconds=0.0)
    assert report.findings == []
    assert report.counts["twin decisions"] == 1
    decisions = len(episode.requested)
    assert f"1 decision of {decisions}, " in report.checked[1]
    assert any("stopped when its time was over" in line for line in report.unchecked)


@pytest.mark.parametrize("name", ["position", "heading", "executed", "status", "body_position"])
def test_a_state_that_is_a_little_off_is_named(name):
    drawn = random_world(1, steps=30)
    episode = play(drawn, 1)
    array = getattr(episode, name).copy()
    array[10 if name == "executed" else 11, 0] += 1 if name == "status" else 2e-6
    report = Report()
    check_twin(drawn, dataclasses.replace(episode, **{name: array}), "here", report)
    (finding,) = report.findings
    assert (finding.kind, finding.where) == ("twin", "here")
    assert finding.what.startswith("decision 10: ")


@pytest.mark.slow
def test_faults_in_kernels_are_found():
    """In a process of its own, where kernels are interpreted and can be changed."""
    done = subprocess.run(
        [sys.executable, str(Path(__file__).with_name("faulty.py"))],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    assert said.pop("") == [[], []]  # nothing is found where nothing is wrong
    assert set(said) == set(FAULTS)
    assert [name for name, (twin, _) in said.items() if not twin] == []
    judged = {name for name, (_, referee) in said.items() if referee}
    assert judged >= JUDGED


def test_the_sample_is_from_everywhere(genuine):
    class Part:
        def __init__(self, first, stop):
            self.seeds = range(first, stop)

    class Cell:
        def __init__(self, identity):
            self.scenario = type("Scenario", (), {"identity": identity})

    checks = [
        PartCheck(Cell(name), Part(first, first + 4), "", 0, "", {}, None)
        for name in ("a", "b") for first in (0, 4)
    ]  # fmt: skip
    assert sampled(checks, 4) == [[0], [4], [0], [4]]
    assert sampled(checks, 2) == [[0], [], [0], []]
    assert sampled(checks, 0) == [[], [], [], []]
    assert np.sum([len(seeds) for seeds in sampled(checks, 1000)]) == 16
