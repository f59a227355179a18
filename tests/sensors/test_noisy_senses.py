"""Noisy senses: the slow twin, equal noise for all, and memory that belongs to one world."""

import math
from dataclasses import replace

import numpy as np
import pytest

from benchnav.arena.noise import EdgeNoise, NeighbourNoise, Noise, OdometryNoise, RayNoise
from benchnav.arena.solid import Kind
from benchnav.sensors.sense import EDGES, NEIGHBOURS, sense
from benchnav.world.simulation import Simulation
from tests.reference import noise as twin
from tests.sensors.noisy import (
    NEEDS,
    active,
    assert_same,
    keys_of,
    noisy,
    state_of,
)
from tests.worlds import agents, random_world, walls, world

CAMERA = 1.6  # [rad]
ALL = Noise(
    RayNoise(0.02, 0.01, 0.003, 0.1, 0.2, CAMERA),
    NeighbourNoise(0.2, 0.3, 0.15, 0.4, 4.0),
    EdgeNoise(0.03, 0.1, CAMERA),
    OdometryNoise(0.05, 0.03, 0.04, 1.0, 0.06, 0.03),
)
STEPS = 14


def drive(simulation, k, towards=None):
    """One decision of all agents: twists that differ between agents and decisions."""
    command = np.zeros((simulation.B, simulation.A, 2))
    command[..., 0] = 0.7 + 0.1 * np.arange(simulation.A) if towards is None else towards
    command[..., 1] = np.sin(0.5 * k + np.arange(simulation.A))
    simulation.step(command, np.ones(command.shape[:2], bool))


def perceived(worlds, noise, steps=STEPS, **options):
    """[(readings, own states)] of every decision."""
    simulation, senses = noisy(worlds, noise, **options)
    seen = []
    for k in range(steps):
        seen.append((senses.sense(active(simulation, senses), NEEDS), state_of(simulation, senses)))
        drive(simulation, k)
    return seen


@pytest.fixture(scope="module")
def crowds():
    return [random_world(seed, 5) for seed in range(4)]


def test_the_readings_are_those_of_the_twin(crowds):
    simulation, senses = noisy(crowds, ALL)
    keys, worlds = keys_of(len(crowds)), range(len(crowds))
    errors = {(b, i): (0.0, 0.0, 0.0) for b in worlds for i in range(simulation.A)}
    poses, compared = {}, 0
    for step in range(STEPS):
        deciding = active(simulation, senses)
        names = {}
        exact = sense(simulation, np.where(deciding, senses._chosen, -1), NEEDS, names)
        rays, near, edges = senses.sense(deciding, NEEDS)
        for b, i in np.argwhere(simulation.present):
            draws = twin.Draws(keys[b], step, int(i))
            own, heading = simulation.position[b, i], float(simulation.heading[b, i])
            pose = (*own.tolist(), heading)
            if step > 0 and step % 5 == 0:  # dt is 0.2 s, the period 1 s
                errors[b, i] = twin.corrected(ALL.odometry, draws)
            elif step > 0:
                errors[b, i] = twin.drifted(errors[b, i], poses[b, i], pose, ALL.odometry, draws)
            poses[b, i] = pose
            error = errors[b, i]
            np.testing.assert_allclose(senses.pose_error[b, i], error, atol=1e-7)
            if not deciding[b, i]:
                continue
            compare_rays(exact[0], rays, b, i, draws)
            compare_neighbours(exact[1], near, names[NEIGHBOURS], b, i, simulation, error, draws)
            compare_edges(exact[2], edges, names[EDGES], b, i, own, heading, error, draws)
            compared += 1
        drive(simulation, step)
    assert compared > 100


def compare_rays(exact, rays, b, i, draws):
    for r, angle in enumerate(exact.angle):
        d, kind, faster, sideways = twin.ray(
            exact.distance[b, i, r], exact.kind[b, i, r], exact.approach[b, i, r],
            exact.across[b, i, r], angle, 8.0, ALL.rays, draws, r, len(exact.angle),
        )  # fmt: skip
        np.testing.assert_allclose(
            (rays.distance[b, i, r], rays.approach[b, i, r], rays.across[b, i, r]),
            (d, faster, sideways), atol=1e-6,
        )  # fmt: skip
        assert rays.kind[b, i, r] == kind


def compare_neighbours(exact, near, names, b, i, simulation, error, draws):
    known = [
        (names[b, i, s], exact.position[b, i, s], exact.velocity[b, i, s], exact.radius[b, i, s],
         exact.kind[b, i, s])
        for s in range(exact.count[b, i])
    ]  # fmt: skip
    own, heading = simulation.position[b, i], simulation.heading[b, i]
    radius = simulation.agents["radius"][b, i]
    expected = twin.neighbours(known, own, heading, radius, 10.0, 10, ALL.neighbours, error, draws)
    assert near.count[b, i] == len(expected)
    for s, (position, velocity, size, kind) in enumerate(expected):
        np.testing.assert_allclose(near.position[b, i, s], position, atol=1e-6)
        np.testing.assert_allclose(near.velocity[b, i, s], velocity, atol=1e-6)
        assert (near.radius[b, i, s], near.kind[b, i, s]) == (size, kind)
    assert not near.position[b, i, len(expected) :].any()


def compare_edges(exact, edges, names, b, i, own, heading, error, draws):
    noise, expected = ALL.edges, []
    for s in range(exact.count[b, i]):
        start, end = exact.start[b, i, s], exact.end[b, i, s]
        along = (end - start) / np.linalg.norm(end - start)
        t = np.clip((own - start) @ along, 0.0, np.linalg.norm(end - start))
        points = (start, end, 0.5 * (start + end), start + t * along)
        if not any(twin.in_view(p, own, heading, noise.field_of_view) for p in points):
            continue
        if draws.uniform(twin.EDGE, names[b, i, s]) < noise.missed:
            continue
        shift = noise.offset_noise * draws.normals(twin.EDGE, names[b, i, s])[0]
        shift = shift * np.array([along[1], -along[0]])
        expected.append([twin.placed(p + shift, own, error) for p in (start, end)])
    assert edges.count[b, i] == len(expected)
    found = [(edges.start[b, i, s], edges.end[b, i, s]) for s in range(len(expected))]
    np.testing.assert_allclose(
        np.sort(np.array(found).reshape(-1, 4), 0), np.sort(np.array(expected).reshape(-1, 4), 0),
        atol=1e-6,
    )  # fmt: skip


def test_no_noise_changes_no_bit(crowds):
    simulation, senses = noisy(crowds, Noise())
    for k in range(STEPS):
        deciding = active(simulation, senses)
        exact = sense(simulation, np.where(deciding, senses._chosen, -1), NEEDS)
        assert_same(senses.sense(deciding, NEEDS), exact)
        for own, true in zip(
            state_of(simulation, senses),
            (simulation.position, simulation.heading, simulation.velocity), strict=True,
        ):  # fmt: skip
            assert own.tobytes() == np.ascontiguousarray(true).tobytes()
        drive(simulation, k)


@pytest.mark.parametrize("delay", [0, 3])
def test_a_world_does_not_depend_on_the_others_in_its_batch(crowds, delay):
    noise = replace(ALL, delay=delay)
    together = perceived(crowds, noise)
    turned = perceived(crowds[::-1], noise, keys=keys_of(len(crowds))[::-1])
    for b in range(len(crowds)):
        alone = perceived(crowds[b : b + 1], noise, keys=keys_of(1, b))
        c = len(crowds) - 1 - b
        for one, other, back in zip(alone, together, turned, strict=True):
            assert_same(one[0], other[0], [0], [b])
            assert_same(back[0], other[0], [c], [b])
            for x, y in zip(one[1], other[1], strict=True):
                assert x[0].tobytes() == y[b].tobytes()


def test_threads_change_nothing(monkeypatch):
    worlds = [random_world(seed, 5) for seed in range(40)]
    several = perceived(worlds, ALL, 5)
    monkeypatch.setenv("BENCHNAV_THREADS", "1")
    for one, other in zip(perceived(worlds, ALL, 5), several, strict=True):
        assert_same(one[0], other[0])


def test_calling_twice_in_a_decision_is_calling_once(crowds):
    noise = replace(ALL, delay=2)
    simulation, senses = noisy(crowds, noise)
    for k, expected in enumerate(perceived(crowds, noise)):
        deciding = active(simulation, senses)
        senses.sense(deciding & (np.arange(simulation.B) % 2 == 0)[:, None], NEEDS)
        assert_same(senses.sense(deciding, NEEDS), expected[0])
        drive(simulation, k)


def test_decisions_must_not_be_left_out(crowds):
    simulation, senses = noisy(crowds, ALL)
    senses.sense(active(simulation, senses), NEEDS)
    drive(simulation, 0)
    drive(simulation, 1)
    with pytest.raises(RuntimeError, match="at every decision"):
        senses.sense(active(simulation, senses), NEEDS)


def met(speed):
    """The errors of readings, by decision, agent, and ray or neighbour, of agents at a speed."""
    noise = Noise(RayNoise(0.1), NeighbourNoise(0.01, 0.3, 0.2))
    start = [[5.0, 5.0], [9.0, 5.0], [5.0, 9.0], [9.0, 9.0]]
    crew = agents(start, np.flip(start, 0) + 3.0, radius=0.3)
    simulation, senses = noisy([world(crew, [walls(20.0)])], noise)
    rays_of, neighbours_of = {}, {}
    for k in range(12):
        names = {}
        exact, there, _ = sense(simulation, senses._chosen, NEEDS, names)
        rays, near, _ = senses.sense(active(simulation, senses), NEEDS)
        for i, r in np.argwhere((exact.kind != Kind.NOTHING)[0] & (rays.kind != Kind.NOTHING)[0]):
            rays_of[k, i, r] = rays.distance[0, i, r] - exact.distance[0, i, r]
        for i in range(4):
            for s in range(near.count[0, i]):
                away = near.position[0, i, s] - there.position[0, i, : there.count[0, i]]
                nearest = np.linalg.norm(away, axis=1).argmin()
                error = near.velocity[0, i, s] - there.velocity[0, i, nearest]
                name = int(names[NEIGHBOURS][0, i, nearest])
                neighbours_of[k, i, name] = (*away[nearest], *error)
        drive(simulation, k, speed)
    return rays_of, neighbours_of


def test_the_noise_of_an_agent_does_not_depend_on_where_it_and_others_went():
    """Two navigators drive differently, and meet the same noise at the same decision."""
    slow, fast = met(0.2), met(0.8)
    shared = slow[0].keys() & fast[0].keys()
    assert len(shared) > 50
    for at in shared:
        assert slow[0][at] == pytest.approx(fast[0][at], abs=1e-9)
    assert slow[1].keys() == fast[1].keys()  # the same neighbours are missed
    assert 0.7 < len(slow[1]) / (12 * 4 * 3) < 0.9
    for at, errors in slow[1].items():
        np.testing.assert_allclose(errors, fast[1][at], atol=1e-9)


def test_late_readings_are_those_of_earlier_decisions_and_the_own_pose_is_of_now(crowds):
    now, late = perceived(crowds, ALL), perceived(crowds, replace(ALL, delay=3))
    for k, (readings, own) in enumerate(late):
        assert own[0].tobytes() == now[k][1][0].tobytes()
        before = now[max(k - 3, 0)][0]
        for part, then in zip(readings, before, strict=True):
            there = now[k][0][1].count > 0  # agents that still decide
            field = "distance" if hasattr(part, "distance") else "count"
            np.testing.assert_array_equal(getattr(part, field)[there], getattr(then, field)[there])


def test_a_row_that_starts_again_remembers_nothing(crowds):
    noise = replace(ALL, delay=2)
    simulation, senses = noisy(crowds[:1], noise)
    for k in range(4):
        senses.sense(active(simulation, senses), NEEDS)
        drive(simulation, k)
    fresh = Simulation(crowds[:1])
    senses._simulation = fresh
    senses.begin(np.array([0]), keys_of(1))
    for k, expected in enumerate(perceived(crowds[:1], noise, 5)):
        assert_same(senses.sense(active(fresh, senses), NEEDS), expected[0])
        drive(fresh, k)


def test_another_key_is_another_noise(crowds):
    one, other = perceived(crowds, ALL, 2), perceived(crowds, ALL, 2, keys=keys_of(4, 9))
    assert (one[1][0][0].distance != other[1][0][0].distance).any()


def test_the_odometry_frame_is_one_frame(crowds):
    """Without errors of the sensors, all that is sensed is where the drifted pose puts it."""
    noise = Noise(odometry=OdometryNoise(0.1, 0.2, 0.2))
    simulation, senses = noisy(crowds, noise)
    for k in range(STEPS):
        deciding = active(simulation, senses)
        exact = sense(simulation, np.where(deciding, senses._chosen, -1), NEEDS)
        rays, near, edges = senses.sense(deciding, NEEDS)
        position, heading, velocity = state_of(simulation, senses)
        true = simulation.position, simulation.heading, simulation.velocity
        np.testing.assert_array_equal(rays.distance, exact[0].distance)
        for b, i in np.argwhere(deciding):
            pairs = [(near.position[b, i, s], exact[1].position[b, i, s])
                     for s in range(near.count[b, i])]  # fmt: skip
            pairs += [(edges.start[b, i, s], exact[2].start[b, i, s])
                      for s in range(edges.count[b, i])]  # fmt: skip
            for seen, there in pairs:
                np.testing.assert_allclose(
                    twin.rotated(seen - position[b, i], -heading[b, i]),
                    twin.rotated(there - true[0][b, i], -true[1][b, i]),
                    atol=1e-9,
                )
            turned = twin.rotated(velocity[b, i], -heading[b, i])
            np.testing.assert_allclose(
                turned, twin.rotated(true[2][b, i], -true[1][b, i]), atol=1e-9
            )
            compare_goal(rays, b, i, simulation.goal[b, i], position[b, i], heading[b, i])
        drive(simulation, k)
    assert np.abs(senses.pose_error[..., 2]).max() > 0.1


def compare_goal(rays, b, i, goal, position, heading):
    """The goal is on the rays where the agent believes it to be."""
    dx, dy = twin.rotated(goal - position, -heading)
    for angle, seen in zip(rays.angle, rays.goal[b, i], strict=True):
        ahead = dx * math.cos(angle) + dy * math.sin(angle)
        aside = dy * math.cos(angle) - dx * math.sin(angle)
        reach = 0.3 + 0.5  # tolerance and radius
        if math.isfinite(seen):
            assert abs(aside) <= reach + 1e-9
            inside = math.hypot(dx, dy) <= reach
            at = 0.0 if inside else ahead - math.sqrt(reach**2 - aside**2)
            assert seen == pytest.approx(at, abs=1e-9)


def test_a_planar_velocity_is_turned_into_the_world_frame(crowds):
    _, senses = noisy(crowds, ALL)
    senses.pose_error[..., 2] = 0.3
    senses.pose_error[0, 0, 2] = 0.0
    asked = np.random.default_rng(0).normal(size=(2, senses.pose_error.shape[1], 2))
    done = senses.in_world_frame(np.array([0, 2]), asked)
    assert done[0, 0].tobytes() == asked[0, 0].tobytes()
    np.testing.assert_allclose(done[1, 0], twin.rotated(asked[1, 0], -0.3))
