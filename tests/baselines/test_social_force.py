import math
from dataclasses import replace

import numpy as np
from benchnav_baselines.controllers.social_force.controller import SocialForce
from benchnav_baselines.controllers.social_force.force import border_force, pedestrian_force, sight

from benchnav.navigation.controller import Guide
from benchnav.navigation.observation import Observation
from benchnav.sensors.readings import Edges, Neighbours
from tests.baselines.crowds import DT, briefing, joined, one_world

V0, SIGMA, U0, R, TAU = 2.1, 0.3, 10.0, 0.2, 0.5  # as published


def guide_to(target):
    return Guide(target, np.full(target.shape[:2], 3.0), np.ones(target.shape[:2], bool))


def steer(seen, told, target, **parameters):
    controller = SocialForce(SocialForce.Config(**{"fluctuation": 0.0, **parameters}))
    controller.reset(told, seen.rows)
    return controller.steer(seen, guide_to(target))


def alone(told, velocity=(0.0, 0.0)):
    """What one agent sees that sees nothing."""
    _, seen = one_world(0, 1)
    return replace(
        seen, position=told.start[None], velocity=np.array([[velocity]]), goal=told.goal[None],
        neighbours=None, edges=None,
    )  # fmt: skip


def test_the_speed_relaxes_as_published():
    """v(t) = v⁰ (1 − exp(−t / τ)), whatever the decision step."""
    told = briefing([(0, 0)], [(50, 0)], preferred=1.34, limit=3.0)
    velocity = (0.0, 0.0)
    for k in range(1, 11):
        velocity = steer(alone(told, velocity), [told], told.goal[None])[0, 0]
        expected = 1.34 * (1.0 - math.exp(-k * DT / TAU))
        np.testing.assert_allclose(velocity, (expected, 0.0), atol=1e-12)


def test_nobody_is_faster_than_1_3_times_the_preferred_speed():
    told = briefing([(0, 0)], [(50, 0)], preferred=1.0, limit=3.0)
    fast = steer(alone(told, (3.0, 0.0)), [told], told.goal[None])[0, 0]
    slower = 1.0 + 0.3 * math.exp(-(DT - 0.05) / TAU)  # limited after a tick, then it relaxes
    np.testing.assert_allclose(fast, (slower, 0.0))


def test_forces_in_configurations_computed_by_hand():
    # beside one who stands, 1 m off: b is the distance, and V⁰/σ exp(−b/σ) = 7 exp(−10/3)
    np.testing.assert_allclose(pedestrian_force(0, 1, 0, 0, V0, SIGMA), (0, 7 * math.exp(-10 / 3)))
    # beside the middle of a step of 0.6 m, 0.4 m off: |r| = |r − s| = 0.5, b = 0.4, and
    # ∇b = (|r| + |r − s|) / 4b (r/|r| + (r−s)/|r−s|) = 1 / 1.6 (0, 1.6)
    force = pedestrian_force(0.3, 0.4, 0.6, 0, V0, SIGMA)
    np.testing.assert_allclose(force, (0, 7 * math.exp(-4 / 3)), atol=1e-12)
    # before a wall, 0.5 m off: U⁰/R exp(−0.5/R) = 50 exp(−2.5)
    force = walls(np.array([[3.0, 0.5, -3.0, 0.5]]))
    np.testing.assert_allclose(force, (0, -50 * math.exp(-2.5)))


def walls(segments, at=(0.0, 0.0), excess=0.0):
    """The force of edges (E, 4), each of which continues straight at both ends."""
    start, end = segments[:, :2].copy(), segments[:, 2:].copy()
    along = (end - start) / np.hypot(*(end - start).T)[:, None]
    return border_force(
        *at, excess, start, end, along, along, len(start), U0, R, np.empty_like(start)
    )


def test_the_force_is_the_gradient_of_the_published_potential():
    def potential(r, s):
        q = r - s
        b = 0.5 * math.sqrt((np.hypot(*r) + np.hypot(*q)) ** 2 - np.hypot(*s) ** 2)
        return V0 * math.exp(-b / SIGMA)

    rng = np.random.default_rng(1)
    for _ in range(200):
        r, s, h = rng.normal(0, 0.6, 2), rng.normal(0, 0.5, 2), 1e-6
        steps = h * np.eye(2)
        slope = [(potential(r + e, s) - potential(r - e, s)) / (2 * h) for e in steps]
        np.testing.assert_allclose(
            pedestrian_force(*r, *s, V0, SIGMA), -np.array(slope), rtol=1e-5, atol=1e-6
        )


def test_within_the_step_the_force_is_finite():
    for x in (0.0, 1e-9, 0.3, 0.6):
        force = pedestrian_force(x, 0.0, 0.6, 0.0, V0, SIGMA)
        assert np.isfinite(force).all()
        assert force[0] >= 0.0
        assert force[1] == 0.0


def test_what_is_out_of_sight_weighs_half():
    cosine = math.cos(math.radians(100.0))
    for degrees, weight in ((0, 1), (90, 1), (99, 1), (101, 0.5), (180, 0.5), (-99, 1)):
        to = np.array([math.cos(math.radians(degrees)), math.sin(math.radians(degrees))])
        assert sight(*(-3.0 * to), 1.0, 0.0, cosine, 0.5) == weight


def test_a_corner_pushes_once_and_two_walls_push_twice():
    corner = np.array([[0.3, 0.4]])
    start, end = np.vstack([corner, (2.0, 0.4)]), np.array([(0.3, 2.4), (0.3, 0.4)])
    along = np.array([(0.0, 1.0), (-1.0, 0.0)])  # the second edge ends where the first begins
    before, after = along[::-1].copy(), along.copy()
    force = border_force(0, 0, 0.0, start, end, before, after, 2, U0, R, np.empty((2, 2)))
    np.testing.assert_allclose(force, -50 * math.exp(-2.5) * np.array([0.6, 0.8]))
    two = walls(np.array([[3, 0.5, -3, 0.5], [-3, -0.5, 3, -0.5]], float), at=(0.0, 0.1))
    np.testing.assert_allclose(two, (0, 50 * (math.exp(-3) - math.exp(-2))))


def wall_before(position):
    """A long wall of its own for each agent (A, 2), 0.6 m off in y."""
    start, end = position + np.array([50.0, 0.6]), position + np.array([-50.0, 0.6])
    along = np.broadcast_to((-1.0, 0.0), start.shape)
    flags = np.ones((1, len(position), 1), bool)
    rows = [a[None, :, None] for a in (start, end, along, along)]
    return Edges(*rows, flags, flags, np.ones((1, len(position)), np.int64))


def slow_step(seen, told, i, target, push, border_body, stride, tick=0.05):
    """The twin of one agent's step, on arrays and without shortcuts."""
    x, v = seen.position[0, i].copy(), seen.velocity[0, i].copy()
    near, edges, h = seen.neighbours, seen.edges, told.dt / round(told.dt / tick)
    for k in range(round(told.dt / tick)):
        way = target - x
        e = way / np.hypot(*way)
        force = push.copy()
        d = edges.start[0, i, 0, 1] - x[1]
        force[1] -= U0 / R * math.exp(-(d - told.radius[i] + border_body) / R)
        for j in range(near.count[0, i]):
            u = near.velocity[0, i, j]
            r = x - near.position[0, i, j] - k * h * u
            gap = max(np.hypot(*r) - told.radius[i] - near.radius[0, i, j], 1e-3)
            f = np.array(pedestrian_force(*(gap * r / np.hypot(*r)), *(stride * u), V0, SIGMA))
            f *= 1.0 if -f @ e >= np.hypot(*f) * math.cos(math.radians(100)) else 0.5
            force += f
        end = min(told.preferred_speed[i], np.hypot(*way) / told.dt) * e + TAU * force
        v = end + (v - end) * math.exp(-h / TAU)
        v *= min(1.0, min(1.3 * told.preferred_speed[i], told.max_speed[i]) / np.hypot(*v))
        x = x + h * v
    return v


def test_a_step_equals_its_slow_twin():
    for world in range(5):
        told, seen = one_world(world, 7)
        seen = replace(seen, edges=wall_before(seen.position[0]))
        target = seen.position + np.random.default_rng(world).normal(0, 2, (1, 7, 2))
        got = steer(seen, [told], target, stride=0.4, border_body=0.1)
        for i in range(7):
            slow = slow_step(seen, told, i, target[0, i], np.zeros(2), 0.1, 0.4)
            np.testing.assert_allclose(got[0, i], slow, atol=1e-9)


def test_batch_does_not_matter():
    told, seen = zip(*(one_world(w, 7) for w in range(3)), strict=True)
    target = np.random.default_rng(1).normal(0, 3, (3, 7, 2))
    together = steer(joined(seen), told, target)
    for w in range(3):
        alone = steer(seen[w], [told[w]], target[w : w + 1])
        np.testing.assert_array_equal(alone[0], together[w])


LENGTH, WIDTH, HALF = 25.0, 5.0, 16  # of a walkway that is closed to a ring; people each way


def walkway(position, velocity):
    """What points (A, 2) in a walkway along x see of each other, across the ends, and its walls."""
    agents, most = len(position), 10
    offset = position[None] - position[:, None]
    offset[..., 0] -= LENGTH * np.round(offset[..., 0] / LENGTH)
    distance = np.hypot(*np.moveaxis(offset, -1, 0))
    np.fill_diagonal(distance, np.inf)
    order = np.argsort(distance, axis=1, kind="stable")[:, :most]
    near = Neighbours(
        (position[:, None] + np.take_along_axis(offset, order[..., None], 1))[None],
        velocity[order][None], np.zeros((1, agents, most)), np.ones((1, agents, most), np.int8),
        np.full((1, agents), most),
    )  # fmt: skip
    far = 10 * LENGTH
    start = np.broadcast_to(np.array([(-far, 0.0), (far, WIDTH)]), (1, agents, 2, 2))
    end = np.broadcast_to(np.array([(far, 0.0), (-far, WIDTH)]), (1, agents, 2, 2))
    along = np.sign(end - start) * (1.0, 0.0)
    flags = np.ones((1, agents, 2), bool)
    edges = Edges(start, end, along, along, flags, flags, np.full((1, agents), 2))
    return Observation(
        rows=np.array([0]),
        time=np.zeros(1),
        active=np.ones((1, agents), bool),
        position=position[None],
        heading=np.zeros((1, agents)),
        velocity=velocity[None],
        goal=position[None],
        maps=(None,),
        rays=None,
        neighbours=near,
        edges=edges,
    )


def lane_order(position, direction, band=0.5):
    """Rex and Löwen 2007: mean of ((like − unlike) / (like + unlike))² within a lateral band."""
    beside = np.abs(position[:, None, 1] - position[None, :, 1]) < band
    np.fill_diagonal(beside, False)
    like = direction[:, None] == direction[None]
    same, other = (beside & like).sum(1), (beside & ~like).sum(1)
    total = np.maximum(same + other, 1)
    return float(np.mean(((same - other) / total) ** 2))


def lanes_after(seed, **parameters):
    """(order at the start, its mean over the second of two minutes) of people at random places."""
    rng = np.random.default_rng(seed)
    direction = np.repeat([1.0, -1.0], HALF)
    position = rng.uniform((0, 0.5), (LENGTH, WIDTH - 0.5), (2 * HALF, 2))
    preferred = np.maximum(rng.normal(1.34, 0.26, 2 * HALF), 0.3)  # [m/s] as published
    told = replace(briefing(position, position, radius=0.0, limit=3.0), preferred_speed=preferred)
    controller = SocialForce(SocialForce.Config(border_body=0.0, **parameters))
    controller.reset([told], np.array([0]))
    velocity = np.stack([direction * preferred, np.zeros(2 * HALF)], axis=1)
    order = [lane_order(position, direction)]
    for _ in range(600):
        target = position + np.stack([10 * direction, np.zeros(2 * HALF)], axis=1)
        velocity = controller.steer(walkway(position, velocity), guide_to(target[None]))[0]
        position = (position + DT * velocity) % (LENGTH, np.inf)
        order.append(lane_order(position, direction))
    assert (position[:, 1] > 0).all()
    assert (position[:, 1] < WIDTH).all()
    return order[0], np.mean(order[300:])


def test_people_who_walk_both_ways_form_lanes():
    """Fig. 2 of the paper: lanes of uniform direction form by themselves, from random starts.

    Without repulsion between pedestrians they do not.
    """
    before, after = np.mean([lanes_after(seed) for seed in range(3)], axis=0)
    _, never = np.mean([lanes_after(seed, pedestrians=0.0) for seed in range(3)], axis=0)
    assert before < 0.2
    assert never < 0.2
    assert after > 0.3
