"""Every channel has the deviation or the probability that its key says."""

import math
from dataclasses import replace

import numpy as np
import pytest

from benchnav.arena.noise import EdgeNoise, NeighbourNoise, Noise, OdometryNoise, RayNoise
from benchnav.arena.sensing import EdgeSensor
from benchnav.arena.solid import Kind
from benchnav.sensors.sense import sense
from tests.sensors.noisy import NEEDS, active, keys_of, noisy
from tests.worlds import SENSING, agents, back_and_forth, disc, walls, world

WORLDS = 600


def standing(extra=(), bodies=()):
    """An agent at (10, 10) that looks along +x, four others around, within walls."""
    start = [[10.0, 10.0], [13.0, 10.0], [10.0, 14.0], [6.0, 10.0], [10.0, 8.0]]
    crew = agents(start, np.flip(start, 0), radius=0.3)
    return world(crew, [walls(20.0), *extra], bodies, sensing=SENSING)


def first_of(noise, one=None):
    """(exact, noisy) readings of agent 0, in worlds that differ in their keys only."""
    one = standing() if one is None else one
    chosen = np.zeros((WORLDS, 1), np.int64)
    simulation, senses = noisy([one] * WORLDS, noise, chosen=chosen)
    deciding = active(simulation, senses)[:, :1]
    return sense(simulation, chosen, NEEDS), senses.sense(deciding, NEEDS)


def test_range_noise_grows_with_the_distance():
    (exact, *_), (rays, *_) = first_of(Noise(RayNoise(0.02, 0.01, 0.003)))
    hit = np.flatnonzero(exact.kind[0, 0] != Kind.NOTHING)
    assert len(hit) > 2
    for r in hit:
        d = exact.distance[0, 0, r]
        deviation = 0.02 + 0.01 * d + 0.003 * d * d
        errors = rays.distance[:, 0, r] - d
        assert errors.mean() == pytest.approx(0.0, abs=4 * deviation / math.sqrt(WORLDS))
        assert errors.std() == pytest.approx(deviation, rel=0.12)
    correlation = np.corrcoef(rays.distance[:, 0, hit].T)
    assert np.abs(correlation - np.eye(len(hit))).max() < 0.2


def test_dropout_of_rays():
    (exact, *_), (rays, *_) = first_of(Noise(RayNoise(dropout=0.3)))
    hit = exact.kind != Kind.NOTHING
    lost = hit & (rays.kind == Kind.NOTHING)
    assert lost[hit].mean() == pytest.approx(0.3, abs=0.05)
    assert (rays.distance[lost] == 8.0).all()
    np.testing.assert_array_equal(rays.distance[~lost], exact.distance[~lost])


def test_noise_of_the_approach_speed():
    mover = back_and_forth(disc(Kind.DYNAMIC, 0.0, 0.0, 0.5), [12.0, 10.0], [11.0, 10.0], 0.7)
    (exact, *_), (rays, *_) = first_of(Noise(RayNoise(approach_noise=0.2)), standing((), [mover]))
    ahead = exact.kind[0, 0] == Kind.DYNAMIC
    errors = rays.approach[:, 0, ahead] - exact.approach[:, 0, ahead]
    assert errors.std() == pytest.approx(0.2, rel=0.1)
    assert (rays.approach[:, 0, ~ahead] == 0.0).all()
    sideways = rays.across[:, 0, ahead] - exact.across[:, 0, ahead]
    assert sideways.std() == pytest.approx(0.2, rel=0.1)
    assert np.abs(np.corrcoef(errors.ravel(), sideways.ravel())[0, 1]) < 0.1
    assert (rays.across[:, 0, ~ahead] == 0.0).all()


@pytest.mark.parametrize("share", [0.3, 0.8])
def test_a_field_of_view(share):
    view = 2 * math.pi * share
    noise = Noise(RayNoise(field_of_view=view), NeighbourNoise(field_of_view=view))
    (exact, near, _), (rays, seen, _) = first_of(noise)
    outside = np.abs(exact.angle) > view / 2
    assert (rays.kind[0, 0, outside] == Kind.NOTHING).all()
    np.testing.assert_array_equal(rays.distance[..., ~outside], exact.distance[..., ~outside])
    away = near.position[0, 0, : near.count[0, 0]] - 10.0
    expected = (np.abs(np.arctan2(away[:, 1], away[:, 0])) <= view / 2).sum()
    assert (seen.count == expected).all()
    assert 0 < expected < near.count[0, 0]


def test_position_and_velocity_noise_of_neighbours():
    noise = Noise(neighbours=NeighbourNoise(0.05, 0.2))
    (_, exact, _), (_, near, _) = first_of(noise)
    assert (near.count == exact.count).all()
    shift = near.position[..., :4, :] - exact.position[..., :4, :]
    kept = np.abs(shift).max(axis=(1, 2, 3)) < 1.0  # the others changed their order
    assert kept.mean() > 0.4
    assert shift[kept].std() == pytest.approx(0.05, rel=0.06)
    assert near.velocity[..., :4, :].std() == pytest.approx(0.2, rel=0.06)
    away = np.linalg.norm(near.position[..., :4, :] - 10.0, axis=3)
    assert (np.diff(away, axis=2) >= 0.0).all()


def test_missed_neighbours_and_false_alarms():
    (_, exact, _), (_, near, _) = first_of(Noise(neighbours=NeighbourNoise(missed=0.25)))
    missed = exact.count - near.count
    assert missed.mean() == pytest.approx(0.25 * exact.count.mean(), abs=0.12)
    assert set(np.unique(missed)) >= {0, 1, 2}
    noise = Noise(neighbours=NeighbourNoise(0.0, 0.1, 0.0, 0.4))
    (_, exact, _), (_, near, _) = first_of(noise)
    false = near.count[:, 0] - exact.count[:, 0]
    assert false.mean() == pytest.approx(0.4, abs=0.08)
    known = {tuple(p) for p in exact.position[0, 0, : exact.count[0, 0]]}
    ghosts = np.array(
        [p for b in np.flatnonzero(false) for p in near.position[b, 0] if p.any()
         and tuple(p) not in known]
    )  # fmt: skip
    assert len(ghosts) == false.sum()
    away = np.linalg.norm(ghosts - 10.0, axis=1)
    assert (away <= 10.0).all()
    assert (away**2).mean() == pytest.approx(50.0, rel=0.12)  # uniform in the disc
    assert np.abs(ghosts.mean(0) - 10.0).max() < 1.2
    assert (near.kind[near.radius > 0] == Kind.AGENT).all()


def in_a_corner():
    """An agent that looks along +x; walls are 2, 4 and 14 m away, one is out of range."""
    sensing = replace(SENSING, edges=EdgeSensor(16, 15.0))
    return world(agents([2.0, 4.0], [9.0, 9.0], radius=0.3), [walls(18.0)], sensing=sensing)


def test_edges_are_shifted_along_their_normals_or_missed():
    (*_, exact), (*_, edges) = first_of(Noise(edges=EdgeNoise(0.04)), in_a_corner())
    n = exact.count[0, 0]
    shift = (edges.start - exact.start)[:, 0, :n]
    along = (exact.end - exact.start)[:, 0, :n]
    assert n == 3
    assert np.abs((along * shift).sum(-1)).max() < 1e-9
    np.testing.assert_allclose((edges.end - exact.end)[:, 0, :n], shift, atol=1e-12)
    assert math.sqrt((shift**2).sum(-1).mean()) == pytest.approx(0.04, rel=0.07)
    (*_, exact), (*_, edges) = first_of(Noise(edges=EdgeNoise(missed=0.3)), in_a_corner())
    assert (edges.count / exact.count).mean() == pytest.approx(0.7, abs=0.04)


def test_edges_beside_the_field_of_view_are_not_seen():
    noise = Noise(edges=EdgeNoise(field_of_view=0.6))
    (*_, exact), (*_, edges) = first_of(noise, in_a_corner())
    assert (exact.count == 3).all()
    assert (edges.count == 1).all()  # the far end of the wall below, which is 4 m away
    assert (edges.start[..., 0, 1] == 0.0).all()


def drift_after(noise, twist, steps, worlds=400):
    """(worlds, 3) pose errors after steps of 0.2 s with one twist."""
    one = world(agents([2.0, 10.0], [18.0, 10.0], radius=0.3, speed=1.0), dt=0.2)
    simulation, senses = noisy([one] * worlds, Noise(odometry=noise), keys=keys_of(worlds))
    command = np.broadcast_to(np.array(twist), (worlds, 1, 2)).copy()
    for _ in range(steps):
        senses.sense(active(simulation, senses), frozenset())
        simulation.step(command, np.ones((worlds, 1), bool))
    senses.sense(active(simulation, senses), frozenset())
    return senses.pose_error[:, 0]


def test_drift_grows_with_the_square_root_of_the_way_whatever_the_speed():
    noise = OdometryNoise(distance_noise=0.1, heading_noise=0.05)
    for speed, steps in ((1.0, 20), (0.25, 80)):  # 4 m
        errors = drift_after(noise, (speed, 0.0), steps)
        assert errors[:, 2].std() == pytest.approx(0.05 * 2.0, rel=0.12)
        assert errors[:, 0].std() == pytest.approx(0.1 * 2.0, rel=0.15)
        across = 0.05 * math.sqrt(4.0**3 / 3.0)  # the integral of the heading's random walk
        assert errors[:, 1].std() == pytest.approx(across, rel=0.15)
        assert np.abs(errors.mean(0) / errors.std(0)).max() < 0.3


def test_turning_drifts_and_standing_does_not():
    noise = OdometryNoise(0.1, 0.05, turning_noise=0.07)
    errors = drift_after(noise, (0.0, 0.5), 40)  # 4 rad
    assert errors[:, 2].std() == pytest.approx(0.07 * 2.0, rel=0.12)
    assert not errors[:, :2].any()
    assert not drift_after(noise, (0.0, 0.0), 10).any()


def test_a_correction_forgets_the_drift():
    noise = OdometryNoise(0.1, 0.5, 0.0, 2.0, 0.05, 0.02)
    errors = drift_after(noise, (1.0, 0.0), 10)  # 2 s
    assert errors[:, :2].std() == pytest.approx(0.05, rel=0.1)
    assert errors[:, 2].std() == pytest.approx(0.02, rel=0.12)
    assert drift_after(noise, (1.0, 0.0), 9)[:, 2].std() > 0.3
