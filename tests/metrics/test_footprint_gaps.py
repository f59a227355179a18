"""Clearance of bodies that are not discs, against shapely."""

import math
from dataclasses import replace

import numpy as np
import pytest

from benchnav.arena.world import ContactRule
from benchnav.episode.episode import Status
from benchnav.metrics.quantities.episode_analysis import analyse
from tests.runner.verify.faulty import play
from tests.runner.verify.test_footprints import long_world
from tests.world.test_footprint import core, fixed_core

SAMPLES = 4


def poses(episode, k, s):
    """Return positions (A, 2) and headings (A,) a share s of a step after state k."""
    turn = episode.heading[min(k + 1, len(episode.heading) - 1)] - episode.heading[k]
    turn = np.remainder(turn + math.pi, 2 * math.pi) - math.pi
    later = episode.position[min(k + 1, len(episode.position) - 1)]
    return episode.position[k] + s * (later - episode.position[k]), episode.heading[k] + s * turn


@pytest.mark.parametrize("seed", range(2))
def test_clearance_is_that_of_the_shapes_at_sampled_times(seed):
    world = long_world(seed, ContactRule.SLIDE)
    crew = replace(world.agents, goal=np.full((8, 2), 100.0))  # nobody arrives
    world = replace(world, agents=crew)
    episode = play(world, seed)
    found = analyse(episode).encounters
    assert (episode.status == int(Status.ACTIVE)).all()
    fixed = [fixed_core(solid) for solid in world.solids]
    expected = np.full(8, math.inf)
    for k in range(len(episode.requested)):
        way = episode.body_position[k + 1] - episode.body_position[k]
        for s in np.arange(SAMPLES) / SAMPLES:
            place, heading = poses(episode, k, s)
            cores = [core(crew, a, place[a], heading[a]) for a in range(8)]
            moved = [
                fixed_core(body.solid.moved(episode.body_position[k, m] + s * way[m]))
                for m, body in enumerate(world.bodies)
            ]
            for a, (own, margin) in enumerate(cores):
                for other, reach in [*cores[:a], *cores[a + 1 :], *fixed, *moved]:
                    expected[a] = min(expected[a], own.distance(other) - margin - reach)
    shallow = expected > -0.05  # shapely knows no depth of cores that meet
    assert shallow.sum() > 4
    assert found.clearance[shallow] == pytest.approx(expected[shallow], abs=1e-6)
