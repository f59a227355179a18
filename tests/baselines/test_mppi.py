import math
from dataclasses import replace

import numpy as np
import pytest
from benchnav_baselines.common.motion_limits import LIMITS
from benchnav_baselines.controllers.mppi.controller import Mppi
from benchnav_baselines.controllers.mppi.cost import cost_of, edge_distances
from benchnav_baselines.controllers.mppi.kernel import control
from benchnav_baselines.controllers.mppi.weights import disturbed, moved_on, weigh

from benchnav.arena.solid import Kind
from benchnav.navigation.controller import Guide
from benchnav.sensors.readings import Neighbours
from tests.baselines.crowds import briefing, joined, keyed, one_world


def weighed(cost, temperature):
    out = np.empty(len(cost))
    return out, weigh(np.array(cost, float), temperature, out)


def test_weights_and_free_energy_equal_the_slow_twin():
    rng = np.random.default_rng(1)
    for temperature in (0.05, 1.0, 20.0):
        cost = rng.uniform(0, 3, 40)
        weight, free = weighed(cost, temperature)
        share = np.exp(-cost / temperature)
        np.testing.assert_allclose(weight, share / share.sum())
        assert free == pytest.approx(-temperature * math.log(share.mean()))


def test_weights_of_dear_samples_do_not_vanish_together():
    weight, free = weighed([1e6, 1e6 + 1.0], 1.0)
    np.testing.assert_allclose(weight, [1 / (1 + math.exp(-1)), 1 / (1 + math.e)])
    assert free == pytest.approx(1e6 - math.log(0.5 * (1 + math.exp(-1))))


def test_cold_takes_the_best_and_hot_takes_all():
    cost = np.random.default_rng(2).uniform(0, 1, 9)
    weight, free = weighed(cost, 1e-6)
    assert weight.argmax() == cost.argmin()
    assert weight.max() == pytest.approx(1.0)
    assert free == pytest.approx(cost.min(), abs=1e-4)
    weight, free = weighed(cost, 1e6)
    np.testing.assert_allclose(weight, 1 / 9, rtol=1e-5)
    assert free == pytest.approx(cost.mean(), abs=1e-5)


def test_the_free_energy_is_below_the_mean_cost_and_rises_with_the_temperature():
    """Jensen's inequality, which the derivation rests on."""
    cost = np.random.default_rng(3).exponential(1.0, 30)
    free = [weighed(cost, t)[1] for t in np.geomspace(0.01, 100, 12)]
    assert (np.diff(free) > 0).all()
    assert cost.min() < free[0]
    assert free[-1] < cost.mean()


def test_a_quadratic_cost_has_the_optimal_distribution_in_closed_form():
    """Samples u ~ N(0, s²) of cost k (u − a)² / 2, weighed by exp(−cost / λ), are normal.

    Their mean is a k s² / (λ + k s²), their variance λ s² / (λ + k s²), and the free energy is
    λ/2 log(1 + k s² / λ) + k a² λ / 2(λ + k s²).
    """
    rng = np.random.default_rng(4)
    k, a, s, temperature = 3.0, 0.7, 0.8, 0.5
    u = rng.normal(0, s, 400_000)
    weight, free = weighed(0.5 * k * (u - a) ** 2, temperature)
    both = temperature + k * s * s
    mean = weight @ u
    assert mean == pytest.approx(a * k * s * s / both, abs=5e-3)
    assert weight @ (u - mean) ** 2 == pytest.approx(temperature * s * s / both, abs=5e-3)
    expected = (
        0.5 * temperature * math.log(both / temperature) + 0.5 * k * a * a * temperature / both
    )
    assert free == pytest.approx(expected, abs=5e-3)


def test_a_plan_moves_on_by_the_time_that_passed():
    plan = np.array([(0, 0), (1, -1), (2, -2), (4, -4)], float)
    out = np.empty_like(plan)
    moved_on(plan, 1.0, out)
    np.testing.assert_allclose(out[:, 0], [1, 2, 4, 4])
    moved_on(plan, 0.5, out)
    np.testing.assert_allclose(out[:, 1], [-0.5, -1.5, -3, -4])


def test_noise_runs_straight_between_knots_and_stays_within_limits():
    plan, out = np.full((5, 2), 0.5), np.empty((5, 2))
    noise = np.array([(1.0, 0.0), (-1.0, 4.0), (1.0, 0.0)])
    disturbed(plan, noise, np.array([0.2, 1.0]), np.array([0.0, -1.0]), np.array([0.6, 3.0]), out)
    np.testing.assert_allclose(out[:, 0], [0.6, 0.5, 0.3, 0.5, 0.6])
    np.testing.assert_allclose(out[:, 1], [0.5, 2.5, 3.0, 2.5, 0.5])


UNLIMITED = np.zeros(1, bool), np.zeros((1, LIMITS)), np.zeros(1)
WEIGHTS = np.array([8.0, 1.5, 0.7, 0.3, 0.4, 2.5, 1.1])


def slow_cost(plan, tick, place, heading, last, goal, final, body, margin, near, edges):
    """The twin of the cost: the whole way first, then each term as a sum over it."""
    contact, probability, close, smooth, clearance, back, close_edges = WEIGHTS
    position, velocity, radius, kind = near
    H, way, course = len(plan), [np.array(place)], heading
    courses = []
    for v, w in plan:
        courses.append(course + 0.5 * w * tick)
        way.append(way[-1] + v * tick * np.array([np.cos(courses[-1]), np.sin(courses[-1])]))
        course += w * tick
    change = np.diff(np.vstack([last, plan]), axis=0) / (body[2], body[3])
    cost, left = 0.0, np.hypot(*(goal - place))
    passed = turned = False
    movers = kind == int(Kind.DYNAMIC)
    for t in range(H):
        cost += smooth * (change[t] ** 2).sum()
        x = way[t + 1]
        others = position + (t + 1) * tick * velocity
        walls = []
        gaps = list(np.hypot(*(others - x).T) - radius - body[0])
        for a, b in zip(*edges, strict=True):
            s = np.clip((x - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
            walls.append(np.hypot(*(a + s * (b - a) - x)) - body[0])
        gap, wall = min(gaps, default=np.inf), min(walls, default=np.inf)
        back_at = (position - (t + 1) * tick * velocity)[movers]
        if not turned and (np.hypot(*(back_at - x).T) - radius[movers] - body[0] < margin).any():
            turned = True
            cost += back * (H - t) / H
        if gap < margin or wall < 0.5 * margin:
            return cost + contact * (1 + (H - t) / H) + left * (H - t) / H, True
        risk = 0.0
        moving = plan[t, 0] * np.array([np.cos(courses[t]), np.sin(courses[t])])
        for j in np.flatnonzero(movers):
            times = np.arange(0, 60, 1e-3)[:, None]
            meet = np.hypot(*(others[j] - x - times * (moving - velocity[j])).T)
            hit = np.flatnonzero(meet <= radius[j] + body[0])
            if len(hit):
                risk = max(risk, min(1.0, 1.0 / max(times[hit[0], 0], 1e-9)))
        cost += probability * risk / H
        cost += close * max(1 - gap / clearance, 0) / H
        cost += close_edges * max(1 - wall / clearance, 0) / H
        if passed:
            left -= plan[t, 0] * tick
        else:
            left = np.hypot(*(goal - x))
            if final and left < body[5]:
                return cost, False
            passed = not final and ((goal - x) @ (goal - place) <= 0 or left < body[0])
        cost += left / H
    return cost, False


def test_the_cost_equals_its_slow_twin():
    rng = np.random.default_rng(5)
    outcomes = {True: 0, False: 0}
    for trial in range(60):
        plan = np.stack([rng.uniform(0, 1.5, 10), rng.normal(0, 1, 10)], axis=1)
        body = np.array([0.3, 2.0, 1.5, 2.5, 0.2, 0.4])
        near = rng.uniform(-4, 4, (3, 2)), rng.normal(0, 0.7, (3, 2)), rng.uniform(0.2, 0.5, 3)
        kind = np.array([int(Kind.AGENT), int(Kind.DYNAMIC), int(Kind.DYNAMIC)], np.int8)
        edges = rng.uniform(-4, 4, (2, 2, 2))
        goal, last, final = rng.uniform(-2, 2, 2), rng.normal(0, 1, 2), bool(trial % 2)
        far = np.empty(2)
        edge_distances(0.1, -0.2, *edges, 2, far)
        fast = cost_of(
            plan, 0.2, 0.1, -0.2, 0.3, last, *goal, final, body, 0.05, *near, kind, 3,
            *edges, far, 2, WEIGHTS,
        )  # fmt: skip
        slow = slow_cost(
            plan, 0.2, (0.1, -0.2), 0.3, last, goal, final, body, 0.05, (*near, kind), edges
        )
        assert fast[0] == pytest.approx(slow[0], abs=2e-3)  # the twin's clock ticks in ms
        assert fast[1] == slow[1]
        outcomes[fast[1]] += 1
    assert min(outcomes.values()) > 10


def test_a_decision_equals_its_slow_twin():
    rng = np.random.default_rng(6)
    samples, steps, temperature, gamma = 12, 6, 0.3, 0.4
    body = np.array([0.3, 2.0, 1.5, 2.5, 0.2, 0.4])
    plan = np.stack([rng.uniform(0, 1.5, steps), rng.normal(0, 1, steps)], axis=1)
    noise = rng.normal(0, 1, (samples, 3, 2))
    near = np.array([[3.0, 0.4]]), np.array([[-0.5, 0.0]]), np.array([0.4])
    kind = np.array([int(Kind.DYNAMIC)], np.int8)
    edges = np.array([[[1.0, 1.2]], [[-1.0, 1.2]]])
    out = np.zeros((1, steps, 2))
    control(
        0, 1, np.ones(1, bool), np.zeros((1, 2)), np.zeros(1), np.array([[2.0, 0.5]]),
        np.array([9.0]), body[None], plan[None], *UNLIMITED, *(a[None] for a in near), kind[None],
        np.array([1]), edges[0][None], edges[1][None], np.array([1]), noise[None], 0.2,
        np.array([0.3, 0.4]), temperature, gamma, 0.05, WEIGHTS, out,
    )  # fmt: skip
    base, tried = np.empty_like(plan), np.empty((samples, steps, 2))
    moved_on(plan, 1.0, base)
    spread = np.array([0.3 * 1.5, 0.4 * 2.5])
    for k in range(samples):
        disturbed(base, noise[k], spread, np.array([0, -2.5]), np.array([1.5, 2.5]), tried[k])
    tried[0], tried[1] = base, 0.0
    told = 0.2, (0.0, 0.0), 0.0, plan[0], np.array([2.0, 0.5]), False, body, 0.05
    cost = np.array([slow_cost(u, *told, (*near, kind), edges)[0] for u in tried])
    cost += gamma * temperature * (base * (tried - base) / spread**2).sum((1, 2)) / steps
    weight = np.exp(-(cost - cost.min()) / temperature)
    mean = (weight[:, None, None] * tried).sum(0) / weight.sum()
    assert not slow_cost(mean, *told, (*near, kind), edges)[1]
    np.testing.assert_allclose(out[0], mean, atol=5e-3)


def test_where_the_mean_touches_the_best_sample_is_taken():
    """Two ways round a post: between them lies the post."""
    body = np.array([0.3, 2.0, 1.0, 3.0, 0.2, 0.4])
    plan = np.full((1, 8, 2), (1.0, 0.0))
    turns = np.array([0.0, 0.0, 1.5, -1.5])
    noise = np.zeros((1, 4, 2, 2))
    noise[0, :, 0, 1], noise[0, :, 1, 1] = turns, -turns
    post = np.array([[[1.2, 0.0]]]), np.zeros((1, 1, 2)), np.array([[0.2]])
    weights = np.array([8.0, 0, 0, 0, 0.1, 0, 0])
    nothing = np.zeros((1, 0, 2))
    out = np.zeros((1, 8, 2))
    control(
        0, 1, np.ones(1, bool), np.zeros((1, 2)), np.zeros(1), np.array([[4.0, 0.0]]),
        np.array([9.0]), body[None], plan, *UNLIMITED, *post,
        np.array([[int(Kind.AGENT)]], np.int8), np.array([1]), nothing, nothing, np.array([0]),
        noise, 0.2, np.array([0.4, 0.5]), 1.0, 0.0, 0.05, weights, out,
    )  # fmt: skip
    expected = 2.25 * (1 - 2 * np.arange(8) / 7)  # one of both ways round, unmixed
    assert np.abs(np.abs(out[0, :, 1]) - np.abs(expected)).max() < 1e-9


def steer(controller, seen, told, target, fresh=True):
    if fresh:
        controller.reset(told, seen.rows)
    at = target.shape[:2]
    return controller.steer(seen, Guide(target, np.full(at, 9.0), np.ones(at, bool)))


def alone(told, neighbours=None):
    _, seen = one_world(0, 1)
    return replace(
        seen, position=told.start[None], velocity=np.zeros((1, 1, 2)), heading=np.zeros((1, 1)),
        goal=told.goal[None], neighbours=neighbours, edges=None,
    )  # fmt: skip


def test_alone_it_drives_straight_at_the_preferred_speed():
    told = briefing([(0, 0)], [(50, 0)], preferred=1.2, limit=2.0)
    controller, target = Mppi(), np.array([[(4.0, 0.0)]])
    for k in range(12):
        twist = steer(controller, alone(told), [told], target, fresh=k == 0)[0, 0]
    assert 1.0 < twist[0] <= 1.2
    assert abs(twist[1]) < 0.5


def test_it_gives_way_to_what_comes_at_it():
    told = briefing([(0, 0)], [(50, 0)], preferred=1.2, limit=2.0)
    mover = Neighbours(
        np.array([[[(3.0, 0.0)]]]), np.array([[[(-1.0, 0.0)]]]), np.full((1, 1, 1), 0.7),
        np.full((1, 1, 1), int(Kind.DYNAMIC), np.int8), np.ones((1, 1), np.int64),
    )  # fmt: skip
    controller, target = Mppi(), np.array([[(4.0, 0.0)]])
    x, y, heading, gaps = 0.0, 0.0, 0.0, []
    for k in range(25):
        ox = 3.0 - 0.2 * k
        here = replace(mover, position=np.array([[[(ox, 0.0)]]]))
        gaps.append(math.hypot(ox - x, y) - 1.0)
        seen = replace(
            alone(told, here), position=np.array([[(x, y)]]), heading=np.array([[heading]])
        )
        v, w = steer(controller, seen, [told], target, fresh=k == 0)[0, 0]
        x += 0.2 * v * math.cos(heading + 0.1 * w)
        y += 0.2 * v * math.sin(heading + 0.1 * w)
        heading += 0.2 * w
    assert min(gaps) > 0.0
    assert x > 1.0  # and it gets past


def test_batch_does_not_matter():
    told, seen = zip(*(one_world(w, 7) for w in range(3)), strict=True)
    target = np.random.default_rng(1).normal(0, 3, (3, 7, 2))
    together = steer(Mppi(), joined(seen), _fresh(told), target)
    for w in range(3):
        alone_ = steer(Mppi(), seen[w], _fresh([told[w]]), target[w : w + 1])
        np.testing.assert_array_equal(alone_[0], together[w])


def _fresh(told):
    """The same briefings with generators that were not drawn from."""
    return [replace(b, rng=keyed(int(1e6 * abs(b.start[0, 0])))) for b in told]
