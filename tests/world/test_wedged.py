"""An agent that is squeezed by obstacles: every one that it overlaps is an event."""

import numpy as np
import pytest

from benchnav.arena.body import Body, Law, LawKind
from benchnav.arena.solid import Kind
from benchnav.verify.reference.reference_simulator import Twin
from benchnav.world.contacts import MAX_HITS
from benchnav.world.simulation import Simulation
from tests.worlds import agents, disc, world

RADIUS, STEPS = 0.3, 20


def squeeze(seed, crowd):
    """A world in which obstacles close in on an agent from all sides, at different times."""
    rng = np.random.default_rng(seed)
    bodies = []
    for k in range(6):
        out = np.array([np.cos(k + 0.3 * seed), np.sin(k + 0.3 * seed)])
        points = 10.0 + np.outer([0.75 + rng.uniform(0, 0.3), 0.3, 1.0], out)
        law = Law(LawKind.TRACK, np.array([0.0, rng.uniform(1, 2), 4.0]), points)
        bodies.append(Body(disc(Kind.DYNAMIC, 0.0, 0.0, RADIUS), law))
    others = [[2.0 + 0.7 * k, 2.0] for k in range(30 if crowd else 0)]
    start = np.array([[10.0, 10.0], *others])
    return world(
        agents(start, start + np.array([0.0, 8.0]), radius=RADIUS), [], bodies, steps=STEPS
    )


@pytest.mark.parametrize("crowd", [False, True])
def test_every_overlap_with_an_obstacle_is_an_event(crowd):
    wedged = 0
    for seed in range(12):
        drawn = squeeze(seed, crowd)
        fast, slow = Simulation([drawn]), Twin(drawn)
        command = np.zeros((1, len(drawn.agents), 2))
        command[0, 0] = [0.3, 0.2]
        deep = set()
        for _ in range(STEPS):
            fast.step(command, np.zeros((1, len(drawn.agents)), bool))
            slow.step(command[0], np.zeros(len(drawn.agents), bool))
            wedged += slow.hits[0] >= MAX_HITS
            gap = np.hypot(*(fast.body_position[0] - fast.position[0, 0]).T) - 2.0 * RADIUS
            deep |= {-1 - int(m) for m in np.flatnonzero(gap < -1e-6)}
        seen = fast.contacts(0)
        assert deep <= set(seen.partner[seen.agent == 0].tolist())
        assert (seen.start >= 0.0).all()
        assert (seen.end >= seen.start).all()
    assert wedged > 0
