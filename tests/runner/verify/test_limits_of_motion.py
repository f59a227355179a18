"""Runs with accelerations, wheels and steering: stored, verified, and faults named."""

import dataclasses
import shutil

import numpy as np
import pyarrow.parquet as pq
import pytest

from benchnav.episode.episode import Status
from benchnav.runner.plan.suite import load_suite
from benchnav.runner.run import run_suite
from benchnav.store.parts.episodes import from_table
from benchnav.store.parts.part import EPISODES_FILE
from tests.runner.verify.forge import Forger, flipped

WHERE = "{type: rectangle, bounds: [-4, -4, 4, 4]}"
PLACES = f"""
    start: {{type: region, region: {WHERE}, separation: 0.3}}
    goal: {{type: region, region: {WHERE}, min_distance: 3}}"""
SCENARIO = f"""
name: tests/bodies
bounds: [-5, -5, 5, 5]
clock: {{horizon: 12}}
static: [{{shape: {{type: disc, radius: 0.4}}, count: 2, region: {{type: anywhere}}}}]
teams:
  - name: cars
    count: 2
    radius: 0.3
    max_speed: 1.2
    max_acceleration: {{uniform: [1, 2]}}
    max_deceleration: 3
    dynamics:
      {{type: ackermann, wheelbase: 0.4, max_steering_angle: 0.6, max_steering_rate: 2,
       reverse: true}}{PLACES}
  - name: wheels
    count: 2
    radius: 0.25
    max_speed: 1
    max_turn_acceleration: 6
    dynamics: {{type: differential-drive, track_width: 0.4, max_wheel_speed: 1}}{PLACES}
  - name: discs
    radius: 0.25
    max_speed: 1
    max_acceleration: 1{PLACES}
"""
SUITE = "name: b\nscenarios: [bodies.yaml]\ntracks: [known]\nnavigators: [orca]\nseeds: 2\n"


@pytest.fixture(scope="module")
def bodies(tmp_path_factory):
    """The run; nobody changes it."""
    folder = tmp_path_factory.mktemp("bodies")
    (folder / "bodies.yaml").write_text(SCENARIO)
    (folder / "suite.yaml").write_text(SUITE)
    run_suite(load_suite(str(folder / "suite.yaml")), folder / "run", workers=0)
    return folder / "run"


def test_a_run_of_bodies_with_limits_is_verified(bodies, findings):
    _, report = findings(bodies, twin=2, rerun=True)
    assert report.findings == []
    assert report.counts["twin decisions"] > 20


def episodes_of(run):
    (stem,) = Forger(run).stems()
    return list(from_table(pq.read_table(stem + EPISODES_FILE)))


def test_executed_commands_hold_the_limits_of_their_world(bodies):
    for episode in episodes_of(bodies):
        agents, dt = episode.world.agents, episode.world.clock.dt
        v, w = np.moveaxis(episode.executed, 2, 0)
        faster = np.diff(abs(v), axis=0, prepend=0.0)[:, :2]
        assert (faster <= agents.max_acceleration[:2] * dt + 1e-12).all()
        drives = episode.status[: len(v), :2] == Status.ACTIVE
        assert (-faster <= agents.max_deceleration[:2] * dt + 1e-12)[drives].all()
        assert (abs(v) + 0.2 * abs(w))[:, 2:4].max() <= 1.0 + 1e-12
        moving = v[:, :2] != 0.0
        curvature = abs(w[:, :2][moving] / v[:, :2][moving])
        assert curvature.max() <= np.tan(0.6) / 0.4 + 1e-9
        assert v[:, :2].max() > 0.5


@pytest.mark.parametrize("agent", [0, 2, 4])
def test_an_executed_command_that_is_off_is_found(bodies, findings, tmp_path, agent):
    shutil.copytree(bodies, tmp_path / "run")
    forger = Forger(tmp_path / "run")
    (stem,) = forger.stems()

    def change(episode):
        executed = episode.executed.copy()
        executed[3, agent, 0] = flipped(float(executed[3, agent, 0]))
        return dataclasses.replace(episode, executed=executed)

    forger.episode(stem, change)
    kinds, _ = findings(forger.run)
    assert kinds & {"state", "command"}


@pytest.mark.parametrize(
    ("name", "agent"), [("max_acceleration", 4), ("max_wheel_speed", 2), ("reverse", 2)]
)
def test_a_limit_that_is_off_is_found(bodies, findings, tmp_path, name, agent):
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
