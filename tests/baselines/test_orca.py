from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from benchnav_baselines.controllers.orca.half_plane import edge_half_plane, neighbour_half_plane
from benchnav_baselines.controllers.orca.kernel import avoid
from benchnav_baselines.controllers.orca.navigator import Orca
from benchnav_baselines.controllers.orca.program import least_excess, nearest_permitted
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.baselines.crowds import DT, answers, briefing, joined, keyed, one_world, permuted
from tests.reference import orca as slow

GOLDEN = Path(__file__).parents[1] / "golden" / "orca_pyrvo_steps.npz"


@pytest.fixture(scope="module")
def steps():
    with np.load(GOLDEN) as stored:
        return dict(stored)


@pytest.mark.parametrize("scene", range(8))
def test_single_steps_of_pyrvo(steps, scene):
    z = {k: v[scene] if v.ndim else float(v) for k, v in steps.items()}
    agents, order = len(z["radius"]), z["neighbour"]
    step_rate = np.full(agents, 1.0 / z["dt"])
    own = np.column_stack(
        [z["position"], z["velocity"], z["wanted"], z["radius"], z["limit"], step_rate]
    )
    answer = np.zeros((agents, 2))
    avoid(
        0, agents, own, np.ones(agents, bool),
        z["position"][order], z["velocity"][order], z["radius"][order],
        np.ones(order.shape, np.int8), (order >= 0).sum(1),
        z["start"], z["end"], z["before"], z["after"], z["start_convex"], z["end_convex"],
        z["edge_count"], order.shape[1], 0.0, np.zeros(agents), 1.0 / z["horizon"],
        1.0 / z["edge_horizon"], answer,
    )  # fmt: skip
    assert np.abs(answer - z["answer"]).max() < 1e-4
    assert np.abs(answer - z["wanted"]).max() > 0.1  # the scene asks for something


def test_golden_scenes_hold_edges_and_crowds(steps):
    assert steps["edge_count"].max() >= 5
    assert (steps["neighbour"] >= 0).sum(-1).max() == steps["neighbour"].shape[-1]


def test_installed_pyrvo_still_answers_what_is_stored(steps):
    pyrvo = pytest.importorskip("pyrvo", reason="pyrvo is a benchmark extra")
    z = {k: v[0] if v.ndim else float(v) for k, v in steps.items()}
    simulator = pyrvo.RVOSimulator()
    simulator.set_time_step(z["dt"])
    simulator.set_agent_defaults(5.0, 8, z["horizon"], z["edge_horizon"], 0.25, 1.0)
    for i, place in enumerate(z["position"].tolist()):
        simulator.add_agent(tuple(place))
        simulator.set_agent_radius(i, float(z["radius"][i]))
        simulator.set_agent_max_speed(i, float(z["limit"][i]))
        simulator.set_agent_velocity(i, tuple(z["velocity"][i].tolist()))
        simulator.set_agent_pref_velocity(i, tuple(z["wanted"][i].tolist()))
    simulator.do_step()
    answer = [simulator.get_agent_velocity(i).to_tuple() for i in range(len(z["radius"]))]
    np.testing.assert_allclose(answer, z["answer"], atol=1e-6)


def as_slow(row):
    return np.array(row[:2]), np.array(row[2:])


@pytest.mark.parametrize("share", [0.5, 1.0])
def test_half_planes_of_neighbours_equal_the_slow_twin(share):
    rng = np.random.default_rng(5)
    kinds = set()
    for _ in range(400):
        p, v, own = rng.normal(0, 2, 2), rng.normal(0, 1, 2), rng.normal(0, 1, 2)
        reach, horizon = rng.uniform(0.2, 1.5), rng.uniform(0.5, 6)
        row = neighbour_half_plane(*p, *v, *own, reach, 1 / horizon, 1 / DT, share)
        point, direction = slow.neighbour(p, v, own, reach, horizon, DT, share)
        np.testing.assert_allclose(row, [*point, *direction], atol=1e-9)
        kinds.add(bool(np.hypot(*p) <= reach))
    assert kinds == {True, False}


def test_an_edge_keeps_as_far_off_as_its_shadow():
    """The half-plane of a lone thin wall touches the forbidden velocities, and nearest to v."""
    rng = np.random.default_rng(6)
    tried = 0
    while tried < 150:
        a, b, v = rng.normal(0, 2, 2), rng.normal(0, 2, 2), rng.normal(0, 1, 2)
        radius, rate = rng.uniform(0.1, 0.4), rng.uniform(0.2, 1.0)
        if slow.det(b - a, -a) > 0:
            a, b = b, a
        outside = slow.distance_to_shadow(v, a, b, rate, radius)
        if slow.distance_to_shadow(np.zeros(2), a, b, 1.0, 0.0) < 1.1 * radius or outside < 0.01:
            continue
        e = slow.unit(b - a)
        made, row = edge_half_plane(*a, *b, *-e, *-e, True, True, *v, radius, rate)
        assert made
        assert slow.permits(as_slow(row), v) == pytest.approx(outside, abs=1e-4)
        tried += 1


def planes_around(rng, count, speed):
    """(rows, twin's form) of ``count`` half-planes, sometimes without a common velocity."""
    angle = rng.uniform(0, 2 * np.pi, count)
    rows = np.column_stack([rng.normal(0, 0.5 * speed, (count, 2)), np.cos(angle), np.sin(angle)])
    return rows, [as_slow(row) for row in rows]


def test_programs_equal_the_slow_twin():
    rng = np.random.default_rng(7)
    feasible = 0
    for _ in range(300):
        hard, count = int(rng.integers(0, 3)), int(rng.integers(1, 7))
        rows, planes = planes_around(rng, hard + count, 1.0)
        wanted = rng.normal(0, 1, 2)
        n = len(rows)
        reached, x, y = nearest_permitted(rows, n, 1.0, *wanted, False)
        best = slow.nearest(planes, 1.0, wanted)
        assert (reached == n) == (best is not None)
        if best is not None:
            feasible += 1
            np.testing.assert_allclose((x, y), best, atol=1e-8)
        elif slow.nearest(planes[:hard], 1.0, wanted) is not None:
            v = np.array(least_excess(rows, n, hard, reached, 1.0, x, y, np.empty_like(rows)))
            excess = max(-slow.permits(plane, v) for plane in planes[hard:])
            least = slow.smallest_excess(planes[:hard], planes[hard:], 1.0)
            assert excess == pytest.approx(least, abs=1e-6)
            assert all(slow.permits(plane, v) >= -1e-9 for plane in planes[:hard])
    assert 50 < feasible < 250


degrees = st.integers(0, 359).map(np.deg2rad)
small = st.floats(-0.7, 0.7)


@settings(max_examples=300, deadline=None)
@given(
    st.tuples(small, small),
    st.lists(st.tuples(degrees, st.floats(0, 2)), max_size=8),
    st.tuples(st.floats(-3, 3), st.floats(-3, 3)),
)
def test_where_something_is_permitted_the_answer_is_permitted(inside, slack, wanted):
    """Half-planes that all hold one velocity: the answer is in all, and nearest among both."""
    rows = np.zeros((len(slack), 4))
    for row, (angle, depth) in zip(rows, slack, strict=True):
        c, s = np.cos(angle), np.sin(angle)
        row[:] = inside[0] + depth * s, inside[1] - depth * c, c, s
    reached, x, y = nearest_permitted(rows, len(rows), 1.0, *wanted, False)
    answer = np.array([x, y])
    if reached < len(rows):  # by rounding, where they have one velocity in common
        answer = np.array(least_excess(rows, len(rows), 0, reached, 1.0, x, y, np.empty_like(rows)))
    assert np.hypot(*answer) <= 1.0 + 1e-9
    assert all(slow.permits(as_slow(row), answer) >= -1e-6 for row in rows)
    if reached == len(rows):
        nearer = np.hypot(*(answer - wanted)) - np.hypot(*(np.array(inside) - wanted))
        assert nearer <= 1e-6


def test_alone_it_drives_straight_and_stops_at_the_goal():
    told = briefing([(0.0, 0.0), (0.0, 5.0)], [(5.0, 0.0), (0.0, 5.1)])
    _, seen = one_world(0, 2)
    seen = replace(
        seen, position=told.start[None], velocity=np.zeros((1, 2, 2)), goal=told.goal[None],
        neighbours=None, edges=None,
    )  # fmt: skip
    command = answers(Orca(Orca.Config(perturbation=0)), [told], seen)
    np.testing.assert_allclose(command, [[[1.0, 0.0], [0.0, 0.1 / DT]]])


def test_beside_a_mover_it_makes_the_whole_effort():
    told, seen = one_world(0, 2, mover=0, spread=1.0)
    told = briefing([(0.0, 0.0), (9.0, 9.0)], [(4.0, 0.0), (9.0, 9.0)])
    neighbours = replace(
        seen.neighbours, position=np.array([[[[2.0, 0.1]], [[0.0, 0.0]]]]),
        velocity=np.array([[[[-1.0, 0.0]], [[0.0, 0.0]]]]), kind=np.ones((1, 2, 1), np.int8),
        radius=np.full((1, 2, 1), 0.3), count=np.array([[1, 0]]),
    )  # fmt: skip
    seen = replace(
        seen, position=told.start[None], goal=told.goal[None], edges=None,
        velocity=np.array([[[1.0, 0.0], [0.0, 0.0]]]), neighbours=neighbours,
    )  # fmt: skip
    config = Orca.Config(perturbation=0, margin=0)
    half = answers(Orca(config), [told], seen)[0, 0]
    mover = replace(seen, neighbours=replace(neighbours, kind=np.full((1, 2, 1), 5, np.int8)))
    whole = answers(Orca(config), [told], mover)[0, 0]
    aside = abs(half[1]), abs(whole[1])
    assert aside[0] > 0.01
    assert aside[1] == pytest.approx(2 * aside[0], rel=0.2)


def test_batch_of_one_equals_batch_and_rows_do_not_leak():
    worlds = [one_world(w, 7) for w in range(5)]
    told, seen = zip(*worlds, strict=True)
    together = answers(Orca(), told, joined(seen))
    for w, (one, view) in enumerate(worlds):
        one = replace(one, rng=keyed(w))
        np.testing.assert_array_equal(answers(Orca(), [one], view)[0], together[w])
    mixed = Orca()
    mixed.reset([replace(b, rng=keyed(w)) for w, b in enumerate(told)], np.arange(5))
    backwards = mixed.act(joined(seen[::-1]))
    np.testing.assert_array_equal(backwards[::-1], together)


def test_numbering_of_agents_does_not_matter():
    told, seen = one_world(1, 9)
    order = np.random.default_rng(1).permutation(9)
    plain = answers(Orca(), [told], seen)
    other = answers(Orca(), *_listed(permuted(replace(told, rng=keyed(1)), seen, order)))
    np.testing.assert_array_equal(other[0], plain[0, order])


def _listed(pair):
    return [pair[0]], pair[1]


def test_inactive_agents_and_padding_change_nothing():
    told, seen = one_world(2, 6)
    plain = answers(Orca(), [told], seen)
    active = np.array([[True, False, True, True, False, True]])
    some = answers(Orca(), [replace(told, rng=keyed(2))], replace(seen, active=active))
    np.testing.assert_array_equal(some[active], plain[active])
    assert np.all(some[~active] == 0.0)


def test_no_command_is_faster_than_the_limit():
    told, seen = one_world(3, 12, spread=1.5)
    speed = np.hypot(*np.moveaxis(answers(Orca(), [told], seen), -1, 0))
    assert speed.max() <= 1.5 + 1e-9


@pytest.mark.parametrize("perturbation", [0.0, 0.005])
def test_degenerate_input_gives_finite_commands(perturbation):
    agents = 6
    place = np.array([(0, 0), (0, 0), (0.1, 0), (5, 5), (1, 0), (1, 0)], float)
    told = briefing(place, place)
    _, seen = one_world(0, agents, mover=0)
    order = np.array([[j for j in range(agents) if j != i] for i in range(agents)])
    neighbours = replace(
        seen.neighbours, position=place[order][None], velocity=np.zeros((1, agents, 5, 2)),
        radius=np.where(order == 3, 0.0, 0.3)[None], kind=np.ones((1, agents, 5), np.int8),
        count=np.full((1, agents), 5),
    )  # fmt: skip
    at = np.zeros((1, agents, 5, 2))
    edges = replace(seen.edges, start=at, end=at.copy(), count=np.full((1, agents), 5))
    edges.end[..., 1:, 0] = 1.0
    edges.before[...] = edges.after[...] = (0.0, 1.0)
    seen = replace(
        seen, position=place[None], goal=place[None], velocity=np.zeros((1, agents, 2)),
        neighbours=neighbours, edges=edges,
    )  # fmt: skip
    command = answers(Orca(Orca.Config(perturbation=perturbation)), [told], seen)
    assert np.isfinite(command).all()


coordinate = st.sampled_from([-1.0, -0.3, 0.0, 0.3, 0.6, 1.0])


@settings(max_examples=200, deadline=None)
@given(st.lists(coordinate, min_size=6, max_size=6), st.booleans(), degrees, degrees)
def test_edges_touched_or_seen_along_never_give_nan(numbers, convex, before, after):
    a, b, v = np.reshape(numbers, (3, 2))
    one, other = (np.cos(before), np.sin(before)), (np.cos(after), np.sin(after))
    _, row = edge_half_plane(*a, *b, *one, *other, convex, convex, *v, 0.3, 0.5)
    assert np.isfinite(row).all()
    assert np.hypot(row[2], row[3]) == pytest.approx(1.0)


def circle(agents, perturbation, seconds):
    """Agents exactly opposite each other on a circle: the last one's distance to its goal."""
    angle = 2 * np.pi * np.arange(agents) / agents
    position = 4.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    told = briefing(position, -position, radius=0.3)
    navigator = Orca(Orca.Config(perturbation=perturbation))
    navigator.reset([told], np.arange(1))
    _, seen = one_world(0, agents, mover=0)
    velocity, gap = np.zeros_like(position), np.inf
    others = np.array([[j for j in range(agents) if j != i] for i in range(agents)])
    for _ in range(int(seconds / DT)):
        distance = np.hypot(*np.moveaxis(position[others] - position[:, None], -1, 0))
        order = np.take_along_axis(others, np.argsort(distance, axis=1, kind="stable"), 1)
        neighbours = replace(
            seen.neighbours, position=position[order][None], velocity=velocity[order][None],
            radius=np.full((1, *order.shape), 0.3), kind=np.ones((1, *order.shape), np.int8),
            count=np.full((1, agents), agents - 1),
        )  # fmt: skip
        view = replace(
            seen, position=position[None], velocity=velocity[None], goal=told.goal[None],
            neighbours=neighbours, edges=None,
        )  # fmt: skip
        velocity = navigator.act(view)[0]
        position = position + DT * velocity
        gap = min(gap, float(distance.min()))
    return float(np.hypot(*(position - told.goal).T).max()), gap


def test_the_perturbation_breaks_exact_symmetry():
    stuck, _ = circle(4, 0.0, 30.0)
    left, gap = circle(4, Orca.Config().perturbation, 30.0)
    assert stuck > 3.0
    assert left < 0.2
    assert gap > 0.6
