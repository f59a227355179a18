"""Runs whose background agents enter later: stored, verified, exported, and faults named."""

import dataclasses
import shutil

import numpy as np
import pyarrow.parquet as pq
import pytest

import benchnav
from benchnav.api.output.export import pedpy_trajectories, trajectory_table
from benchnav.episode.episode import Status
from benchnav.runner.plan.suite import load_suite
from benchnav.runner.run import run_suite
from benchnav.store.parts.episodes import from_table
from benchnav.store.parts.part import EPISODES_FILE
from benchnav.verify.finding import Report
from benchnav.verify.reference.reference_check import check_twin
from tests.runner.verify.faulty import play
from tests.runner.verify.forge import Forger, flipped
from tests.worlds import random_world

SCENARIO = """
name: tests/stream
bounds: [-5, -5, 5, 5]
clock: {dt: 0.2, horizon: 15}
teams:
  - name: robots
    radius: 0.3
    max_speed: 1
    start: {type: points, points: [[-4, 0]]}
    goal: {type: points, points: [[4, 0]]}
  - name: walkers
    count: 6
    radius: 0.3
    max_speed: 1.2
    driver: orca
    enters: {every: 0.5, begin: 1}
    start: {type: region, region: {type: rectangle, bounds: [1, 3, 1.2, 3.2]}}
    goal: {type: region, region: {type: rectangle, bounds: [0, -4, 1, -3]}}
"""
SUITE = "name: s\nscenarios: [s.yaml]\ntracks: [known]\nnavigators: [straight-line]\nseeds: 2\n"
WAITING = int(Status.WAITING)


@pytest.fixture(scope="module")
def stream(tmp_path_factory):
    """The run; nobody changes it."""
    folder = tmp_path_factory.mktemp("stream")
    (folder / "s.yaml").write_text(SCENARIO)
    (folder / "suite.yaml").write_text(SUITE)
    run_suite(load_suite(str(folder / "suite.yaml")), folder / "run", workers=0)
    return folder / "run"


@pytest.fixture(scope="module")
def episode(stream):
    (stem,) = Forger(stream).stems()
    found = from_table(pq.read_table(stem + EPISODES_FILE))
    return next(each for each in found if each.identity.seed == 0)  # their order is salted


def test_agents_enter_in_their_order_where_there_is_room(episode):
    entered = (episode.status == WAITING).sum(axis=0)
    assert entered[:2].tolist() == [0, 5]
    assert (np.diff(entered[1:]) > 0).all()  # their starts are within 0.3 m of each other
    assert (entered[2:] > np.ceil(episode.world.agents.enters[2:] / 0.2)).any()
    assert (episode.status[-1] != WAITING).all()


def test_a_run_with_entries_is_verified(stream, findings):
    _, report = findings(stream, twin=2, rerun=True)
    assert report.findings == []
    assert report.counts["twin decisions"] > 50


@pytest.mark.parametrize("name", ["status", "enters"])
def test_an_entry_that_is_off_is_found(stream, findings, tmp_path, name):
    shutil.copytree(stream, tmp_path / "run")
    forger = Forger(tmp_path / "run")
    (stem,) = forger.stems()

    def change(episode):
        if name == "status":
            status = episode.status.copy()
            status[4, 1] = int(Status.ACTIVE)  # one decision early
            return dataclasses.replace(episode, status=status)
        enters = episode.world.agents.enters.copy()
        enters[3] = flipped(float(enters[3]))
        agents = dataclasses.replace(episode.world.agents, enters=enters)
        return dataclasses.replace(episode, world=dataclasses.replace(episode.world, agents=agents))

    forger.episode(stem, change)
    assert findings(forger.run)[0] & {"state", "world"}


@pytest.mark.parametrize("agents", [8, 30])
def test_the_twin_agrees_on_agents_that_enter(agents):
    report = Report()
    for seed in range(3):
        drawn = random_world(seed, agents, radius=0.25, steps=30)
        start = drawn.agents.start[np.arange(agents) // 2]  # two for each place
        enters = np.where(np.arange(agents) % 2, np.linspace(0.1, 4.0, agents), 0.0)
        late = dataclasses.replace(drawn.agents, start=start, enters=enters)
        drawn = dataclasses.replace(drawn, agents=late)
        check_twin(drawn, play(drawn, seed), f"seed {seed}", report)
    assert report.findings == []
    assert report.counts["twin decisions"] == 90


def test_tables_leave_out_what_is_before_the_entry(stream, episode):
    first = (episode.status == WAITING).sum(axis=0) * 0.2
    frame = benchnav.open_run(stream).episodes(seed=0)[0].to_pandas()
    np.testing.assert_allclose(frame.groupby("agent")["time"].min(), first)
    assert set(frame["status"]) == {"active", "arrived"}
    walk = frame[(frame["agent"] == 1) & (frame["status"] == "active")]
    np.testing.assert_allclose(np.diff(walk["x"]) / 0.2, walk["vx"][:-1], atol=1e-9)
    np.testing.assert_allclose(trajectory_table(episode).groupby("id")["time"].min(), first)
    pedpy = pedpy_trajectories(episode).data
    np.testing.assert_allclose(pedpy.groupby("id")["frame"].min() * 0.2, first)
