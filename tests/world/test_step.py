"""The step against its slow twin, and what must hold of every step."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchnav.arena.body import Body, Law, LawKind
from benchnav.arena.solid import Kind
from benchnav.arena.world import Afterwards, Charge, ContactRule
from benchnav.episode.episode import Status
from benchnav.verify.reference.reference_geometry import law_position
from benchnav.world.simulation import Simulation
from tests.reference.step import SlowWorld
from tests.worlds import agents, back_and_forth, box, disc, random_world, walls, world


def drive(simulation, steps, seed=0, twist=False):
    """Noisy commands towards the goals; yields the command of every step."""
    rng = np.random.default_rng(seed)
    kind = np.full((simulation.B, simulation.A), twist)
    for _ in range(steps):
        towards = simulation.goal - simulation.position
        length = np.maximum(np.linalg.norm(towards, axis=-1, keepdims=True), 1e-9)
        noise = rng.normal(size=towards.shape)
        command = noise + np.array([1.0, 0.0]) if twist else 1.5 * towards / length + 0.5 * noise
        simulation.step(command, kind)
        yield command


@pytest.mark.parametrize("contact", list(ContactRule))
@pytest.mark.parametrize(
    ("unicycle", "twist"), [(True, True), (True, False), (False, True), (False, False)]
)
def test_agrees_with_its_slow_twin(contact, unicycle, twist):
    touches = 0
    for seed in range(4):
        drawn = random_world(seed, contact=contact, unicycle=unicycle, steps=60)
        fast, slow = Simulation([drawn]), SlowWorld(drawn)
        for command in drive(fast, 60, seed, twist):
            slow.step(command[0], twist)
            there = np.array([agent.p for agent in slow.agents])
            np.testing.assert_allclose(fast.position[0], there, atol=1e-8)
            names = [Status(s).name.lower() for s in fast.status[0]]
            assert names == [agent.status for agent in slow.agents]
        touches += len(slow.events)
        first = {(i, who) for _, i, who in slow.events if who[0] != "goal"}
        seen = fast.contacts(0)
        rows = zip(seen.agent.tolist(), seen.kind.tolist(), seen.partner.tolist(), strict=True)
        assert {named(drawn, i, who) for i, who in first} <= set(rows)
    assert touches > 5


def named(drawn, agent, who):
    what, k = who
    if what == "solid":
        return agent, int(drawn.solids[k].kind), k
    if what == "body":
        return agent, int(drawn.bodies[k].solid.kind), -1 - k
    return agent, int(Kind.AGENT), k


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000), st.booleans())
def test_nobody_enters_walls_or_obstacles(seed, unicycle):
    """However agents are driven, static geometry and other agents are never overlapped."""
    still = random_world(seed, count=6, unicycle=unicycle)
    drawn = world(still.agents, still.solids)
    simulation = Simulation([drawn])
    for _ in drive(simulation, 40, seed):
        for i in np.flatnonzero(simulation.present[0]):
            p = simulation.position[0, i]
            for solid in drawn.solids:
                for c in solid.capsules:
                    assert distance(p, c) - c[4] >= 0.5 - 1e-6
            for j in np.flatnonzero(simulation.present[0]):
                assert i == j or np.hypot(*(p - simulation.position[0, j])) >= 1.0 - 1e-6
    assert simulation.contacts(0).penetration.max(initial=0.0) <= 1e-6


def distance(p, c):
    d = c[2:4] - c[:2]
    u = np.clip((p - c[:2]) @ d / max(d @ d, 1e-300), 0, 1)
    return np.hypot(*(p - c[:2] - u * d))


def states(worlds, steps=60, order=None):
    simulation = Simulation(worlds)
    rng = [
        np.random.default_rng(id_) for id_ in (order if order is not None else range(len(worlds)))
    ]
    for _ in range(steps):
        command = np.array([r.normal(size=(simulation.A, 2)) * 2 for r in rng])
        simulation.step(command, np.zeros((simulation.B, simulation.A), bool))
    return simulation


def test_a_batch_is_its_worlds_bit_for_bit():
    worlds = [random_world(seed, count=3 + seed % 3) for seed in range(12)]

    def alone(seed):
        simulation = Simulation([worlds[seed]])
        rng = np.random.default_rng(seed)
        n = simulation.A
        for _ in range(60):
            simulation.step(rng.normal(size=(5, 2))[None, :n] * 2, np.zeros((1, n), bool))
        return simulation

    together = states(worlds)
    for seed in range(12):
        single = alone(seed)
        n = single.A
        assert together.position[seed, :n].tobytes() == single.position[0].tobytes()
        assert together.heading[seed, :n].tobytes() == single.heading[0].tobytes()
        a, b = together.contacts(seed), single.contacts(0)
        assert a.start.tobytes() == b.start.tobytes()
        assert a.partner.tobytes() == b.partner.tobytes()


@pytest.mark.parametrize("threads", ["1", "2", "5"])
def test_threads_do_not_matter(threads, monkeypatch):
    worlds = [random_world(seed) for seed in range(40)]
    expected = states(worlds).position.tobytes()
    monkeypatch.setenv("BENCHNAV_THREADS", threads)
    assert states(worlds).position.tobytes() == expected


def test_a_crowd_in_a_grid_is_a_crowd_by_brute_force():
    rng = np.random.default_rng(3)
    spots = np.stack(np.meshgrid(np.arange(6), np.arange(6)), -1).reshape(-1, 2) * 2.6 + 3.0
    crew = agents(spots, rng.uniform(2, 18, (36, 2)))
    drawn = world(crew, [walls(20.0)], steps=80)
    grid, slow = Simulation([drawn]), SlowWorld(drawn)
    compared = 0
    for command in drive(grid, 15):
        slow.step(command[0], False)
        if max(agent.hits for agent in slow.agents) > 5:
            break  # wedged between several others: rounding decides who gives way
        there = np.array([agent.p for agent in slow.agents])
        np.testing.assert_allclose(grid.position[0], there, atol=1e-7)
        compared += 1
    assert compared >= 4
    assert len(slow.events) > 20


@pytest.mark.parametrize("speed", [1.0, 30.0, 1000.0, 1e5])
def test_nothing_tunnels_at_any_speed(speed):
    thin = box(Kind.WALL, 10.0, 10.0, 0.005, 9.9)
    drawn = world(agents([5.0, 10.0], [15.0, 10.0], speed=speed), [walls(20.0), thin])
    simulation = Simulation([drawn])
    for _ in range(60):
        simulation.step(np.array([[[speed, 0.0]]]), np.zeros((1, 1), bool))
    assert simulation.position[0, 0, 0] == pytest.approx(10.0 - 0.505, abs=1e-6)
    seen = simulation.contacts(0)
    assert seen.kind.tolist() == [Kind.WALL]
    assert seen.closing_speed[0] == pytest.approx(speed)
    assert seen.start[0] == pytest.approx((4.495 / speed) % 1e9, rel=1e-9)


@pytest.mark.parametrize("speed", [1.0, 50.0])
def test_two_agents_head_on_meet_in_the_middle(speed):
    crew = agents([[5.0, 10.0], [15.0, 10.0]], [[15.0, 10.0], [5.0, 10.0]], speed=speed)
    simulation = Simulation([world(crew)])
    for _ in range(40):
        simulation.step(np.array([[[speed, 0.0], [-speed, 0.0]]]), np.zeros((1, 2), bool))
    np.testing.assert_allclose(simulation.position[0, :, 0], [9.5, 10.5], atol=1e-6)
    seen = simulation.contacts(0)
    assert seen.agent.tolist() == [0, 1]
    assert seen.partner.tolist() == [1, 0]
    assert seen.start == pytest.approx(4.5 / speed)
    assert seen.closing_speed == pytest.approx(2 * speed)


def test_a_mover_never_yields_and_pushes():
    mover = back_and_forth(box(Kind.DYNAMIC, 0, 0, 0.5, 0.5), [5, 10], [15, 10], 1.0)
    simulation = Simulation([world(agents([8.0, 10.2], [1.0, 1.0]), bodies=[mover])])
    for k in range(40):
        simulation.step(np.zeros((1, 1, 2)), np.zeros((1, 1), bool))
        expected = 5.0 + min(0.2 * (k + 1), 10)
        assert simulation.body_position[0, 0, 0] == pytest.approx(expected, abs=1e-12)
    assert simulation.position[0, 0, 0] == pytest.approx(5.0 + 8.0 + 1.0, abs=1e-6)
    seen = simulation.contacts(0)
    assert (seen.kind[0], seen.partner[0]) == (Kind.DYNAMIC, -1)
    assert seen.start[0] == pytest.approx(2.0)
    assert seen.end[-1] == pytest.approx(8.0)
    assert len(seen) == 1


def test_an_agent_between_mover_and_wall_is_overlapped_and_let_go():
    mover = back_and_forth(box(Kind.DYNAMIC, 0, 0, 0.5, 0.5), [10, 10], [19.2, 10], 1.0)
    simulation = Simulation([world(agents([18.0, 10.0], [1, 1]), [walls(20.0)], [mover])])
    for _ in range(80):
        simulation.step(np.zeros((1, 1, 2)), np.zeros((1, 1), bool))
    seen = simulation.contacts(0)
    squeezed = seen.penetration[seen.kind == Kind.DYNAMIC].max()
    assert squeezed == pytest.approx(0.7, abs=1e-6)  # radius, and 0.2 m from centre to its far face
    assert simulation.position[0, 0, 0] <= 19.5 + 1e-6


@pytest.mark.parametrize("rule", list(ContactRule))
def test_contact_rules(rule):
    drawn = world(agents([2.0, 2.0], [18.0, 18.0]), [walls(20.0)], contact=rule)
    simulation = Simulation([drawn])
    for _ in range(20):
        simulation.step(np.array([[[-1.0, 1.0]]]), np.zeros((1, 1), bool))
    x, y = simulation.position[0, 0]
    assert x == pytest.approx(0.5, abs=1e-6)
    if rule == ContactRule.SLIDE:
        assert y == pytest.approx(6.0)
        assert simulation.status[0, 0] == Status.ACTIVE
    if rule == ContactRule.STOP:  # stands for the rest of each decision that touches
        assert y == pytest.approx(3.5)
    if rule == ContactRule.END:
        assert y == pytest.approx(3.5)
        assert simulation.status[0, 0] == Status.ENDED
        assert not simulation.running[0]
        assert simulation.contacts(0).end[0] == pytest.approx(1.5)


def test_arrival_is_exact_within_a_step():
    simulation = Simulation([world(agents([2.0, 2.0], [8.0, 2.0]), tolerance=0.25)])
    for _ in range(30):
        simulation.step(np.array([[[2.0, 0.0]]]), np.zeros((1, 1), bool))
    assert simulation.arrival[0, 0] == pytest.approx(5.75 / 2.0)
    assert simulation.position[0, 0, 0] == pytest.approx(7.75)
    assert not simulation.present[0, 0]
    assert simulation.steps_done[0] == 15


def test_a_fast_agent_does_not_jump_over_its_goal():
    simulation = Simulation([world(agents([2.0, 2.0], [8.0, 2.0], speed=40), tolerance=0.01)])
    simulation.step(np.array([[[40.0, 0.0]]]), np.zeros((1, 1), bool))
    assert simulation.arrival[0, 0] == pytest.approx(5.99 / 40)


@pytest.mark.parametrize("charge", list(Charge))
def test_who_is_charged_when_an_arrived_body_is_hit(charge):
    crew = agents([[5.0, 5.0], [9.0, 5.0]], [[15.0, 5.0], [9.1, 5.0]])
    drawn = world(crew, on_arrival=Afterwards.STAY, charge=charge)
    simulation = Simulation([drawn])
    for _ in range(20):
        simulation.step(np.array([[[2.0, 0.0], [0.0, 0.0]]]), np.zeros((1, 2), bool))
    assert simulation.status[0].tolist() == [Status.ACTIVE, Status.ARRIVED]
    seen = simulation.contacts(0)
    assert seen.agent.tolist() == [0, 1]
    assert seen.charged.tolist() == [True, charge == Charge.BOTH]
    np.testing.assert_allclose(simulation.position[0, 0], [8.0, 5.0], atol=1e-6)


def test_a_vanished_agent_is_no_obstacle():
    crew = agents([[5.0, 5.0], [9.0, 5.0]], [[15.0, 5.0], [9.1, 5.0]])
    simulation = Simulation([world(crew)])
    for _ in range(40):
        simulation.step(np.array([[[2.0, 0.0], [0.0, 0.0]]]), np.zeros((1, 2), bool))
    assert len(simulation.contacts(0)) == 0
    assert simulation.status[0].tolist() == [Status.ARRIVED] * 2


def test_a_replaced_obstacle_waits_until_its_place_is_free():
    new = Law(LawKind.RELOCATE, np.array([0.0, 1.0]), np.array([[5.0, 5.0], [10.0, 10.0]]))
    shelf = Body(box(Kind.STATIC, 0, 0, 1, 1), new)
    simulation = Simulation([world(agents([10.0, 10.0], [1, 1]), bodies=[shelf])])
    for k in range(30):
        away = [1.0, 0.0] if k >= 10 else [0.0, 0.0]
        simulation.step(np.array([[away]]), np.zeros((1, 1), bool))
        moved = simulation.revision[0] == 1
        np.testing.assert_array_equal(simulation.body_position[0, 0], [10, 10] if moved else [5, 5])
        if k < 10:
            assert not moved
    assert moved
    assert len(simulation.contacts(0)) == 0


def test_sliding_round_a_disc_is_one_event():
    pillar = disc(Kind.STATIC, 10.0, 10.0, 1.0)
    simulation = Simulation([world(agents([7.0, 10.1], [19.0, 10.0]), [pillar])])
    for _ in range(60):
        simulation.step(np.array([[[1.5, 0.0]]]), np.zeros((1, 1), bool))
    assert simulation.position[0, 0, 0] > 11.5
    seen = simulation.contacts(0)
    assert len(seen) == 1
    assert seen.end[0] - seen.start[0] > 0.5


def test_a_unicycle_turns_at_its_rate_and_follows_an_arc():
    crew = agents([10.0, 10.0], [1.0, 1.0], unicycle=True)
    simulation = Simulation([world(crew, substeps=8, dt=0.1)])
    for _ in range(10):
        simulation.step(np.array([[[1.0, 9.0]]]), np.ones((1, 1), bool))
    assert simulation.heading[0, 0] == pytest.approx(2.5)
    radius = 1.0 / 2.5
    exact = [10 + radius * math.sin(2.5), 10 + radius * (1 - math.cos(2.5))]
    np.testing.assert_allclose(simulation.position[0, 0], exact, atol=1e-4)


def test_failed_agents_stand_and_end_the_world():
    simulation = Simulation([random_world(1, count=2)])
    simulation.fail(0, np.array([0]))
    assert simulation.running[0]
    here = simulation.position[0, 0].copy()
    simulation.step(np.ones((1, 2, 2)), np.zeros((1, 2), bool))
    np.testing.assert_array_equal(simulation.position[0, 0], here)
    simulation.fail(0, np.array([1]))
    assert not simulation.running[0]
    assert simulation.status[0].tolist() == [Status.FAILED] * 2


def test_worlds_of_one_batch_share_clock_and_rules():
    with pytest.raises(ValueError, match="share their clock and rules"):
        Simulation([random_world(1), random_world(1, tolerance=0.1)])


def mixed_world(seed):
    """Agents of different radii and speeds, close enough to touch often."""
    rng = np.random.default_rng(seed)
    spots = np.stack(np.meshgrid(np.arange(4), np.arange(4)), -1).reshape(-1, 2) * 1.2 + 6.0
    radius, speed = rng.uniform(0.2, 0.55, 16), rng.uniform(0.5, 2.0, 16)
    return world(agents(spots, 20.0 - spots[::-1], radius, speed), [walls(20.0)])


def run_towards(simulation, steps):
    twist = np.zeros((simulation.B, simulation.A), bool)
    for _ in range(steps):
        simulation.step(2.0 * (simulation.goal - simulation.position), twist)
    return simulation


def slow_top_speed(drawn):
    top = float(drawn.agents.max_speed.max())
    for law in (body.law for body in drawn.bodies):
        if law.kind == LawKind.CIRCLE:
            top = max(top, abs(law.times[0] * law.points[1, 0]))
        elif law.kind == LawKind.TRACK and len(law.times) > 1:
            legs = np.hypot(*np.diff(law.points, axis=0).T)
            top = max(top, (legs / np.diff(law.times)).max())
    return top


def test_bodies_start_on_their_laws_and_reach_covers_their_speed():
    circle = Law(LawKind.CIRCLE, np.array([7.0]), np.array([[1.0, 2.0], [3.0, 0.5]]), True)
    drawn = [random_world(seed) for seed in range(4)]
    drawn[2] = replace(
        drawn[2], bodies=(*drawn[2].bodies, Body(disc(Kind.DYNAMIC, 0, 0, 0.3), circle))
    )
    simulation = Simulation(drawn)
    h = drawn[0].clock.dt / drawn[0].clock.substeps
    for b, one in enumerate(drawn):
        radius = float(one.agents.radius.max())
        assert simulation.records["reach"][b] >= 2.0 * (radius + slow_top_speed(one) * h)
        for m in range(len(one.bodies)):
            here, soon = (law_position(one.bodies[m], t, False) for t in (0.0, h))
            np.testing.assert_allclose(simulation.body_position[b, m], here, atol=1e-12)
            velocity = (soon - here) / h
            np.testing.assert_allclose(simulation.body_velocity[b, m], velocity, atol=1e-9)


def test_a_big_fast_world_in_the_batch_changes_no_bit_of_the_others():
    giant = world(agents([10.0, 10.0], [1.0, 1.0], radius=3.0, speed=40.0), [walls(20.0)])
    worlds = [mixed_world(seed) for seed in range(12)]
    together = run_towards(Simulation([*worlds, giant]), 40)
    for seed, drawn in enumerate(worlds):
        alone = run_towards(Simulation([drawn]), 40)
        assert alone.position[0].tobytes() == together.position[seed].tobytes()
        mine, theirs = alone.contacts(0), together.contacts(seed)
        assert len(mine) > 3
        assert mine.end.tobytes() == theirs.end.tobytes()


def test_a_slow_agent_stays_in_contact_whatever_shares_the_batch():
    """A gap below the release distance is noticed though the agent moves only 2.5 mm a substep."""
    crew = agents([1.0, 10.0], [19.0, 10.0], radius=0.3, speed=0.1)
    slow = world(crew, [walls(20.0)], dt=0.05)
    simulation = Simulation([slow])
    for k in range(160):
        push = [-1.0, 0.0] if k < 150 else [0.1, 0.0]  # 0.7 m to the wall takes 7 s
        simulation.step(np.array([[push]]), np.zeros((1, 1), bool))
    seen = simulation.contacts(0)
    assert len(seen) == 1
    assert seen.start[0] == pytest.approx(7.0)
    assert seen.end[0] == pytest.approx(7.6, abs=0.051)  # left at 7.5 s, 1 cm away 0.1 s later


def test_a_holonomic_body_turns_at_the_rate_it_is_told():
    crew = agents([[10.0, 10.0], [5.0, 5.0]], [[1.0, 1.0]] * 2)
    simulation = Simulation([world(crew)])
    for _ in range(5):
        simulation.step(np.array([[[1.0, 1.0], [0.0, 1.0]]]), np.ones((1, 2), bool))
    np.testing.assert_allclose(simulation.heading[0], [1.0, 1.0])
