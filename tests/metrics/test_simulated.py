"""Metrics of episodes that the simulator made agree with what it says itself."""

from dataclasses import replace

import numpy as np
import pytest

from benchnav.arena.body import Body, Law, LawKind
from benchnav.arena.solid import Kind, Solid
from benchnav.arena.world import Afterwards
from benchnav.episode.episode import Contacts, Episode, Identity, Status, Timings
from benchnav.metrics.measure import all_metrics, measure
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.metrics.safety import min_time_to_collision
from benchnav.testing.check_metric import values
from benchnav.testing.episodes import RULES, Setting, Walk, box, record, room, straight
from benchnav.world.simulation import Simulation

BOUNDS = (-8.0, -8.0, 8.0, 8.0)


def _world(afterwards):
    law = Law(LawKind.TRACK, np.array([0.0, 6.0, 12.0]), np.array([[-5, 0], [5, 0.3], [-5, 0.0]]))
    mover = Body(Solid(Kind.DYNAMIC, radius=0.5), law)
    goals = np.random.default_rng(3).permutation(np.linspace(-7.0, 6.0, 6))
    walks = [
        Walk(straight((-7.0 + 2.6 * n, -7.0), (0.0, 0.0)), (float(x), 7.0))
        for n, x in enumerate(goals)
    ]
    solids = (room(BOUNDS), box((0.0, 3.0), 2.0, 1.0), box((-4.0, -3.0), 1.0, 1.0))
    rules = replace(RULES, on_arrival=afterwards)
    setting = Setting(
        bounds=BOUNDS, solids=solids, bodies=(mover,), rules=rules, horizon=25.0,
        body_paths=(straight((0.0, 0.0), (0.0, 0.0)),),
    )  # fmt: skip
    return record(walks, setting).world


def _simulated(afterwards, seed):
    """Everybody walks to its goal, shaken, looking at nothing."""
    simulation = Simulation([_world(afterwards)])
    names = ("position", "heading", "status", "body_position")
    states = {name: [getattr(simulation, name)[0].copy()] for name in names}
    commands, rng = [], np.random.default_rng(seed)
    while simulation.running.any():
        to = simulation.world(0).agents.goal[None] - simulation.position
        length = np.maximum(np.hypot(to[..., 0], to[..., 1]), 1e-9)[..., None]
        command = to / length + rng.normal(0.0, 0.3, to.shape)
        commands.append(simulation.step(command, np.zeros(to.shape[:2], np.bool_))[0].copy())
        for name in names:
            states[name].append(getattr(simulation, name)[0].copy())
    state = {name: np.stack(kept) for name, kept in states.items()}
    return Episode(
        Identity("s/x@1", "h", "test", seed, "known", "shaken"), simulation.world(0),
        requested=np.stack(commands), executed=np.stack(commands),
        arrival=simulation.arrival[0].copy(), contacts=simulation.contacts(0),
        timings=Timings(np.full(len(commands), 1e-3), 0.0, 1), **state,
    )  # fmt: skip


@pytest.mark.parametrize("afterwards", list(Afterwards))
@pytest.mark.parametrize("seed", [0, 1])
def test_metrics_agree_with_the_simulator(afterwards, seed):
    episode = _simulated(afterwards, seed)
    found, contacts = analyse(episode), episode.contacts
    depth = np.full(6, -np.inf)
    np.maximum.at(depth, contacts.agent, contacts.penetration)
    touched = np.isfinite(depth)
    assert touched.any()
    # a step that bends at a corner is recorded as its chord, which may cut the corner by a hair
    assert found.encounters.clearance[touched] == pytest.approx(-depth[touched], abs=0.02)
    assert (found.encounters.clearance[~touched] > -0.02).all()
    assert (found.encounters.time_to_collision[touched] < 0.15).all()  # blocked in mid-step
    assert (min_time_to_collision(episode)[touched] == 0.0).all()
    arrived = found.arrived
    assert arrived.any()
    assert (found.trajectories.end[arrived] == episode.arrival[arrived]).all()
    distance = np.hypot(*(episode.world.agents.goal - found.trajectories.position[:, -1]).T)
    assert distance[arrived] == pytest.approx(episode.world.rules.goal_tolerance, abs=1e-9)
    assert (found.trajectories.length[arrived] >= found.geodesic[arrived] - 0.02).all()
    for row in measure(episode, all_metrics()):
        assert not np.isinf(row["value"])


def test_episode_without_a_single_decision_can_be_measured():
    """A navigator that fails in its reset leaves the first state and nothing else."""
    whole = _simulated(Afterwards.VANISH, 0)
    none = Contacts(*(getattr(whole.contacts, f)[:0] for f in Contacts.__dataclass_fields__))
    episode = replace(
        whole, position=whole.position[:1], heading=whole.heading[:1],
        status=np.full((1, 6), int(Status.FAILED), np.int8), requested=whole.requested[:0],
        executed=whole.executed[:0], body_position=whole.body_position[:1],
        arrival=np.full(6, np.nan), contacts=none, timings=Timings(np.zeros(0), 0.1, 1),
        failure="RuntimeError: no",
    )  # fmt: skip
    area = replace(episode.world, measurement_area=(-2.0, -2.0, 2.0, 2.0))
    for case in (episode, replace(episode, world=area)):
        found = {metric.name: values(metric, case) for metric in all_metrics()}
        assert (found["failed"] == 1.0).all()
        assert (found["success"] == 0.0).all()
        assert (found["path_length"] == 0.0).all()
        assert np.isnan(found["turning"]).all()
        assert np.isnan(found["decision_time_p50"]).all()
        assert np.isnan(found["jam"]).all()
