"""An agent that enters later has the metrics of the same attempt at t = 0."""

from dataclasses import replace

import numpy as np
import pytest

from benchnav.metrics.attempt_ends import attempt_ends
from benchnav.metrics.measure import all_metrics
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.metrics.quantities.trajectory import present_at
from benchnav.testing.check_metric import values
from benchnav.testing.episodes import Setting, Walk, box, record, straight, wave
from benchnav.testing.zoo import zoo

LATE = 3.0
WHOLE = {"timeout", "stuck"}  # of the record, which is longer


def walk(enters):
    path = wave((-3.0, 0.3), 0.8, 0.5, 2.6)
    return Walk(lambda t: path(t - enters), (2.2, 0.3), driver=1, enters=enters)


def shifted(enters):
    """A walk past a box and past an agent that stands, which enters together with it."""
    beside = straight((0.0, -1.6), (0.0, 0.0))
    walks = (
        Walk(straight((-15.0, 15.0), (0.0, 0.0)), (15.0, 15.0)),
        walk(enters),
        Walk(beside, (9.0, -1.6), driver=1, enters=enters),
    )
    return record(walks, Setting(solids=(box((0.0, 2.0), 1.0, 1.0),), dt=0.2))


@pytest.mark.parametrize("metric", all_metrics(), ids=lambda metric: metric.name)
def test_metrics_of_an_agent_count_from_its_entry(metric):
    if metric.scope == "group" or metric.name in WHOLE:
        return
    early, late = (values(metric, shifted(enters)) for enters in (0.0, LATE))
    np.testing.assert_allclose(late[1], early[1], rtol=1e-9, atol=1e-9)


def test_before_its_entry_an_agent_is_nowhere():
    """The evaluated agent passes the start of another, which enters behind it."""
    walks = (
        Walk(straight((-3.0, 0.0), (1.0, 0.0)), (9.0, 0.0)),
        Walk(straight((0.0, 0.0), (0.0, 0.0)), (0.0, 9.0), driver=1, enters=5.0),
    )
    found = analyse(record(walks, Setting(horizon=8.0)))
    np.testing.assert_allclose(found.encounters.clearance, 2.0 - 0.6, atol=1e-9)
    assert (found.encounters.gap[1, :50] == found.encounters.gap.max()).all()
    alone = analyse(record(walks[:1], Setting(horizon=8.0)))
    assert found.encounters.time_to_collision[0] == alone.encounters.time_to_collision[0]
    times = np.array([0.0, 4.9, 5.0, 8.0])
    here = present_at(found.trajectories, times)
    assert here.tolist() == [[True] * 4, [False, False, True, True]]
    np.testing.assert_array_equal(found.trajectories.has_body.sum(axis=1), [81, 31])


def test_an_agent_that_does_not_enter_has_no_attempt():
    episode = zoo()["late"]
    found = analyse(episode)
    assert found.trajectories.total_duration[2] == 0.0
    assert found.trajectories.length[2] == 0.0
    assert not found.trajectories.has_body[2].any()
    assert np.isinf(found.encounters.clearance[2])
    assert attempt_ends(episode)[2] == "did not enter"
    without = first_agents(episode, 2)
    for metric in all_metrics():
        if metric.scope == "agent":
            np.testing.assert_array_equal(values(metric, episode)[:2], values(metric, without))


def first_agents(episode, count):
    """The episode without the other agents, which touch nothing."""
    world = episode.world
    columns = {name: column[:count] for name, column in vars(world.agents).items()}
    parts = {name: getattr(episode, name)[:, :count] for name in PARTS}
    world = replace(world, agents=type(world.agents)(**columns))
    return replace(episode, world=world, arrival=episode.arrival[:count], **parts)


PARTS = ("position", "heading", "status", "requested", "executed")
