"""The encounter kernels against their slow twins, on random worlds."""

import numpy as np
import pytest

from benchnav.metrics.quantities.encounters import RECORDED, TTC_CAP, Things, encounters
from benchnav.metrics.quantities.trajectory import Trajectories
from tests.reference import encounters as slow


def _random(rng, agents, steps, size):
    """Piecewise straight motion; some stop early in mid-step, some of these vanish."""
    dt = 0.2
    velocity = np.cumsum(rng.normal(0, 0.5, (agents, steps, 2)), axis=1)
    last = np.where(rng.random(agents) < 0.5, steps, rng.integers(0, steps + 1, agents))
    duration = np.where(np.arange(steps) < last[:, None], dt, 0.0)
    stops = (last < steps) & (last > 0)
    for a in np.flatnonzero(stops):
        duration[a, last[a] - 1] = dt * rng.random()
    velocity[duration == 0.0] = 0.0
    start = rng.uniform(-size, size, (agents, 1, 2))
    path = np.cumsum(velocity * duration[..., None], axis=1)
    position = np.concatenate([start, start + path], axis=1)
    leaves = np.where((rng.random(agents) < 0.5) & (last < steps), last, steps + 1)
    length = np.hypot(*np.diff(position, axis=1).transpose(2, 0, 1)).sum(axis=1)
    return Trajectories(
        dt, last, duration.sum(axis=1), position, duration, velocity, leaves, length, length > 0.3
    )


def _things(rng, steps, size):
    ends = rng.uniform(-size, size, (6, 4))
    capsules = np.hstack([ends, np.zeros((6, 1))])
    capsules[1] = [1.0, 1.0, 1.0, 1.0, 0.4]
    capsules[2] = [-0.3, 0.0, 0.3, 0.0, 0.0]
    capsules[3] = [0.0, 0.0, 0.0, 0.0, 0.5]
    capsules[4] = [0.0, -0.4, 0.0, 0.4, 0.0]
    offset = rng.uniform(-size, size, (3, 1, 2)) + np.cumsum(
        rng.normal(0, 0.1, (3, steps + 1, 2)), axis=1
    )
    jump = int(rng.integers(0, steps))
    offset[2] = np.where(np.arange(steps + 1)[:, None] <= jump, offset[2, :1], offset[2, -1:] + 1.0)
    jumps = np.array([False, False, True])
    return Things(capsules, np.array([-1, -1, 0, 1, 2, -1]), offset, jumps)


@pytest.mark.parametrize("seed", range(6))
def test_kernels_agree_with_their_twins(seed):
    rng = np.random.default_rng(seed)
    size = [1.5, 4.0, 20.0][seed % 3]
    t = _random(rng, 4, 7, size)
    radius = rng.uniform(0.1, 0.4, 4)
    things = _things(rng, 7, size)
    found = encounters(t, radius, things)
    motion = (t.position, t.velocity, t.duration, t.last)
    for a in range(4):
        expected = [slow.things(a, *motion, radius, t.dt, *things)]
        gaps, near = np.full(8, RECORDED), np.zeros(8, bool)
        for j in set(range(4)) - {a}:
            *both, gap, close = slow.pair(a, j, *motion, t.leaves, radius, t.dt)
            expected.append(tuple(both))
            gaps, near = np.minimum(gaps, gap), near | close
        clearance, ttc = np.array(expected).min(axis=0)
        assert found.clearance[a] == pytest.approx(clearance, abs=1e-7)
        assert found.time_to_collision[a] == pytest.approx(min(ttc, TTC_CAP), abs=1e-5)
        np.testing.assert_allclose(found.gap[a], gaps, atol=1e-12)
        np.testing.assert_array_equal(found.near[a], near)


def test_nothing_there_is_no_encounter():
    rng = np.random.default_rng(1)
    nothing = Things(
        np.zeros((0, 5)), np.zeros(0, np.int64), np.zeros((0, 8, 2)), np.zeros(0, np.bool_)
    )
    found = encounters(_random(rng, 1, 7, 1.0), np.array([0.3]), nothing)
    assert np.isinf(found.clearance).all()
    assert (found.time_to_collision == TTC_CAP).all()


def test_long_walk_past_far_partners_skips_nothing_that_matters():
    """A thousand steps past a post: the skipping search finds the one step that counts."""
    steps, dt = 1000, 0.1
    velocity = np.full((1, steps, 2), 0.0)
    velocity[..., 0] = 1.0
    position = np.zeros((1, steps + 1, 2))
    position[0, :, 0] = -61.73 + dt * np.arange(steps + 1)
    duration = np.full((1, steps), dt)
    t = Trajectories(
        dt, np.array([steps]), np.array([100.0]), position, duration, velocity,
        np.array([steps + 1]), np.array([100.0]), np.array([True]),
    )  # fmt: skip
    post = Things(
        np.array([[0.0, 1.0, 0.0, 1.0, 0.2]]), np.array([-1]), np.zeros((0, 0, 2)),
        np.zeros(0, np.bool_),
    )  # fmt: skip
    found = encounters(t, np.array([0.3]), post)
    assert found.clearance[0] == pytest.approx(0.5, abs=1e-12)
    assert found.time_to_collision[0] == TTC_CAP
