"""Runs with bodies that are not discs: stored, verified three times, and faults named."""

import dataclasses
import shutil

import numpy as np
import pyarrow.parquet as pq
import pytest

from benchnav.arena.world import ContactRule
from benchnav.runner.plan.suite import load_suite
from benchnav.runner.run import run_suite
from benchnav.store.parts.episodes import from_table
from benchnav.store.parts.part import EPISODES_FILE
from benchnav.verify.finding import Report
from tests import worlds
from tests.runner.verify.forge import Forger, flipped
from tests.runner.verify.test_referee import judged, pair_of
from tests.world.test_footprint import SHAPES, shaped

WHERE = "{type: rectangle, bounds: [-4, -4, 4, 4]}"
PLACES = f"""
    start: {{type: region, region: {WHERE}}}
    goal: {{type: region, region: {WHERE}, min_distance: 3}}"""
SCENARIO = f"""
name: tests/footprints
bounds: [-5, -5, 5, 5]
clock: {{horizon: 10}}
static: [{{shape: {{type: box, width: 0.8}}, count: 2, region: {{type: anywhere}}}}]
dynamic:
  - {{shape: {{type: disc, radius: 0.3}}, count: 1, region: {{type: anywhere}},
     law: {{type: back-and-forth, length: 3, speed: 0.6}}}}
teams:
  - name: long
    count: 3
    footprint: {{type: capsule, length: {{uniform: [0.7, 1.1]}}, width: 0.4}}
    max_speed: 1
    dynamics: unicycle{PLACES}
  - name: wide
    count: 2
    footprint: {{type: rounded-box, length: 0.4, width: 0.7, corner_radius: 0.1}}
    max_speed: 1{PLACES}
  - name: discs
    count: 2
    radius: 0.25
    max_speed: 1{PLACES}
"""
SUITE = "name: b\nscenarios: [s.yaml]\ntracks: [known]\nnavigators: [straight-line]\nseeds: 2\n"


@pytest.fixture(scope="module")
def bodies(tmp_path_factory):
    """The run; nobody changes it."""
    folder = tmp_path_factory.mktemp("footprints")
    (folder / "s.yaml").write_text(SCENARIO)
    (folder / "suite.yaml").write_text(SUITE)
    run_suite(load_suite(str(folder / "suite.yaml")), folder / "run", workers=0)
    return folder / "run"


def episodes_of(run):
    (stem,) = Forger(run).stems()
    return list(from_table(pq.read_table(stem + EPISODES_FILE)))


def test_a_run_of_footprints_is_verified(bodies, findings):
    _, report = findings(bodies, twin=2, rerun=True)
    assert report.findings == []
    assert report.counts["twin decisions"] > 20
    assert sum(len(episode.contacts) for episode in episodes_of(bodies)) > 3


@pytest.mark.parametrize(
    ("name", "agent"), [("half_length", 0), ("half_width", 3), ("rounding", 6), ("heading", 1)]
)
def test_a_shape_that_is_off_is_found(bodies, findings, tmp_path, name, agent):
    shutil.copytree(bodies, tmp_path / "run")
    forger = Forger(tmp_path / "run")
    (stem,) = forger.stems()

    def change(episode):
        column = getattr(episode.world.agents, name).copy()
        column[agent] = flipped(column[agent].item())
        agents = dataclasses.replace(episode.world.agents, **{name: column})
        return dataclasses.replace(episode, world=dataclasses.replace(episode.world, agents=agents))

    forger.episode(stem, change)
    assert "world" in findings(forger.run)[0]


def test_a_heading_that_is_off_is_found(bodies, findings, tmp_path):
    shutil.copytree(bodies, tmp_path / "run")
    forger = Forger(tmp_path / "run")
    (stem,) = forger.stems()

    def change(episode):
        heading = episode.heading.copy()
        heading[5, 0] = flipped(float(heading[5, 0]))
        return dataclasses.replace(episode, heading=heading)

    forger.episode(stem, change)
    assert "state" in findings(forger.run)[0]


def long_world(seed, rule):
    """Return a small full world with discs among long bodies."""
    rng = np.random.default_rng(seed)
    base = worlds.random_world(seed, 8, rule, radius=0.7, steps=50)
    shapes = np.array([*SHAPES[:3], (0.0, 0.0, 0.0)])[rng.integers(4, size=8)]
    crew = shaped(base.agents, shapes)
    crew = dataclasses.replace(crew, radius=np.where(crew.rounding > 0.0, crew.radius, 0.5))
    return dataclasses.replace(base, agents=crew)


@pytest.mark.parametrize("rule", list(ContactRule))
def test_the_referee_agrees_on_footprints(rule):
    fcl_check = pytest.importorskip("benchnav.verify.reference.fcl_check")
    report = Report()
    for seed in range(3):
        fcl_check.judge(pair_of(long_world(seed, rule), seed), report)
    assert report.findings == []
    assert report.counts["judged events"] > 5


def test_the_referee_misses_events_that_were_left_out():
    pair = pair_of(long_world(4, ContactRule.SLIDE), 4)
    shape = pair.again.world.agents.rounding > 0.0
    turned = dataclasses.replace(pair.again, heading=pair.again.heading + 0.5 * np.pi * shape)
    kept = dataclasses.replace(pair, again=turned)
    assert judged(pair) == []
    assert judged(kept)
