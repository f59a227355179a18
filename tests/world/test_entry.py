"""Agents that enter the arena within an episode: presence, occupied starts, the slow twin."""

from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchnav.arena.agents import Agents
from benchnav.arena.solid import Kind
from benchnav.episode.episode import Status
from benchnav.sensors.sense import sense
from benchnav.verify.reference.reference_simulator import Twin
from benchnav.world.simulation import Simulation
from tests.worlds import agents, back_and_forth, box, disc, random_world, world

DT = 0.2
NEEDS = frozenset(("rays", "neighbours", "edges"))
WAITING, ACTIVE = int(Status.WAITING), int(Status.ACTIVE)


def entering(here, enters):
    """The world whose agents enter at ``enters`` [s]; the first one is evaluated."""
    count = len(here.agents)
    times = np.broadcast_to(np.array(enters, float), count).copy()
    return replace(here, agents=replace(here.agents, enters=times))


def run(here, steps, seed=0):
    """The simulation before each step, with random commands that do not depend on the world."""
    simulation, rng = Simulation([here]), np.random.default_rng(seed)
    twist = np.zeros((1, simulation.A), bool)
    for _ in range(steps):
        yield simulation
        commands = rng.normal(size=(1, 64, 2))[:, : simulation.A] * 2.0
        simulation.step(np.ascontiguousarray(commands), twist)


def first_entry(here, agent, steps=60):
    """The time [s] at which an agent enters; None: it does not within ``steps``."""
    return next((k * DT for k, s in enumerate(run(here, steps)) if s.present[0, agent]), None)


def test_an_agent_is_absent_until_it_enters_and_ignores_commands():
    here = world(agents([[2, 2], [10, 10]], [[18, 2], [18, 18]], driver=[0, 1], enters=[0, 1.0]))
    for k, s in enumerate(run(here, 20)):
        entered = k * DT >= 1.0 - 1e-9
        assert s.present[0, 1] == entered
        assert s.status[0, 1] == (ACTIVE if entered else WAITING)
        if k * DT <= 1.0:
            np.testing.assert_array_equal(s.position[0, 1], [10, 10])
            np.testing.assert_array_equal(s.velocity[0, 1], [0, 0])
    assert np.hypot(*(s.position[0, 1] - 10)) > 0.1


@pytest.mark.parametrize(("enters", "entered"), [(0.7, 0.8), (0.6, 0.6), (1e-12, 0.0), (99, None)])
def test_it_enters_with_the_first_decision_at_or_after_its_time(enters, entered):
    here = world(agents([[2, 2], [10, 10]], [[18, 2], [18, 18]], enters=[0, enters]))
    found = first_entry(here, 1)
    assert found == (None if entered is None else pytest.approx(entered))


def test_sensors_do_not_see_it_before():
    here = world(agents([[5, 5], [8, 5]], [[18, 5], [18, 18]], enters=[0, 1.0]))
    simulation = Simulation([here])
    for k in range(8):
        rays, neighbours, _ = sense(simulation, np.array([[0, -1]]), NEEDS)
        there = k * DT >= 1.0 - 1e-9
        assert neighbours.count[0, 0] == there
        assert (rays.kind[0, 0] == int(Kind.AGENT)).any() == there
        simulation.step(np.zeros((1, 2, 2)), np.zeros((1, 2), bool))


def test_nothing_touches_it_before():
    """An agent drives through the start of another, which enters behind it."""
    crew = agents([[5, 10], [9, 10]], [[18, 10], [1, 10]], speed=2.0, enters=[0, 6.0])
    simulation = Simulation([world(crew)])
    for _ in range(25):
        simulation.step(np.array([[[2.0, 0.0], [0.0, 0.0]]]), np.zeros((1, 2), bool))
    assert not len(simulation.contacts(0))
    assert simulation.position[0, 0, 0] == pytest.approx(15.0)


def test_it_waits_until_its_start_is_free_and_does_not_hold_up_others():
    crew = agents(
        [[10, 10], [10, 10.9], [3, 3]], [[18, 10], [18, 18], [18, 3]], radius=0.5,
        enters=[0, 0.4, 0.6],
    )  # fmt: skip
    simulation = Simulation([world(crew)])
    entered = {}
    for k in range(20):
        for i in np.flatnonzero(simulation.present[0]):
            entered.setdefault(int(i), k * DT)
        command = np.zeros((1, 3, 2))
        command[0, 0, 0] = 1.0 if k >= 5 else 0.0  # agent 0 stands for a second, then leaves
        simulation.step(command, np.zeros((1, 3), bool))
    assert entered[2] == pytest.approx(0.6)
    # free once the centres are 1 m apart: agent 0 has gone √(1 - 0.81) m at 1 m/s
    assert entered[1] == pytest.approx(1.0 + DT * np.ceil(np.sqrt(1 - 0.9**2) / DT))


def test_agents_that_wait_for_one_place_enter_in_the_order_of_their_times():
    crew = agents(
        [[1, 1], [10, 10], [10, 10], [10, 10]], [[2, 1], *[[18, 10]] * 3], radius=0.5,
        enters=[0, 0.6, 0.2, 0.6],
    )  # fmt: skip
    simulation, entered = Simulation([world(crew)]), {}
    for k in range(30):
        for i in np.flatnonzero(simulation.present[0]):
            entered.setdefault(int(i), k)
        command = np.zeros((1, 4, 2))
        command[0, 1:, 0] = 1.0
        simulation.step(command, np.zeros((1, 4), bool))
    assert entered[0] == 0
    assert entered[2] == 1
    assert entered[2] < entered[1] < entered[3]


@pytest.mark.parametrize("shape", [disc, box], ids=["disc", "box"])
def test_it_waits_for_a_moving_obstacle(shape):
    size = (0.8,) if shape is disc else (0.8, 0.8)
    mover = back_and_forth(shape(Kind.DYNAMIC, 0, 0, *size), (4, 10), (16, 10), 2.0)
    here = world(agents([[1, 1], [10, 10]], [[2, 1], [18, 18]], enters=[0, 2.6]), bodies=[mover])
    # the obstacle is above the start from 2.35 s (1.3 m before it) to 3.65 s
    assert first_entry(here, 1) == pytest.approx(3.8)


def test_a_place_within_a_hollow_of_an_obstacle_is_not_free():
    """The centre of a wide obstacle is far from its edges."""
    mover = back_and_forth(box(Kind.DYNAMIC, 0, 0, 3.0, 3.0), (4, 10), (16, 10), 2.0)
    here = world(agents([[1, 1], [10, 10]], [[2, 1], [18, 18]], enters=[0, 3.0]), bodies=[mover])
    assert first_entry(here, 1) == pytest.approx(4.8)


def test_an_episode_does_not_wait_for_background_agents():
    crew = agents([[5, 5], [10, 10]], [[5.1, 5], [18, 18]], driver=[0, 1], enters=[0, 5.0])
    simulation = Simulation([world(crew)])
    simulation.step(np.zeros((1, 2, 2)), np.zeros((1, 2), bool))
    assert not simulation.running[0]


def test_a_relocated_obstacle_does_not_wait_for_agents_that_are_absent():
    from benchnav.arena.body import Body, Law, LawKind

    law = Law(LawKind.RELOCATE, np.array([0.0, 1.0]), np.array([[5.0, 15.0], [10.0, 10.0]]))
    body = Body(disc(Kind.STATIC, 0, 0, 0.6), law)
    here = world(agents([[1, 1], [10, 10]], [[2, 1], [18, 18]], enters=[0, 3.0]), bodies=[body])
    *_, s = run(here, 12)
    np.testing.assert_array_equal(s.body_position[0, 0], [10, 10])


LATE = np.array([0, 0.5, 1.0, 0.2, 2.0, 0, 1.4, 3.0])


@pytest.mark.parametrize("unicycle", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_the_twin_agrees(seed, unicycle):
    """Several agents share a start, and movers cross it."""
    drawn = random_world(seed, 8, unicycle=unicycle, radius=0.3)
    start = drawn.agents.start.copy()
    start[[4, 6]] = start[1]
    here = entering(replace(drawn, agents=replace(drawn.agents, start=start)), LATE)
    assert_twin(here)


def test_the_twin_agrees_on_shapes_that_are_not_discs():
    shape = {"half_length": 0.5, "half_width": 0.2, "rounding": 0.2}
    assert_twin(entering(random_world(4, 8, radius=0.5, limits=shape), LATE))


def assert_twin(here, steps=30):
    simulation, twin = Simulation([here]), Twin(here)
    rng, twist = np.random.default_rng(1), np.zeros((1, len(here.agents)), bool)
    for _ in range(steps):
        command = rng.normal(size=(1, len(here.agents), 2))
        simulation.step(command, twist)
        twin.step(command[0], twist[0])
        np.testing.assert_array_equal(simulation.status[0], twin.status)
        np.testing.assert_array_equal(simulation.present[0], twin.present)
        np.testing.assert_allclose(simulation.position[0], twin.position, atol=1e-7)
        twin.position = simulation.position[0].copy()  # rounding does not accumulate
        twin.heading = simulation.heading[0].copy()
    assert simulation.present[0].any()


def readings(simulation, chosen):
    """Bits of the states of some agents, and of everything that they perceive."""
    rays, neighbours, edges = sense(simulation, chosen, NEEDS)
    parts = [getattr(simulation, name)[0, chosen[0]] for name in STATES]
    parts += [rays.distance, rays.kind, neighbours.position, neighbours.count, edges.start]
    return [np.ascontiguousarray(part).tobytes() for part in parts]


STATES = ("position", "heading", "velocity", "status")


@settings(max_examples=20, deadline=None)
@given(
    st.integers(0, 10_000), st.sampled_from([3, 23, 30]), st.integers(1, 4), st.booleans()
)  # fmt: skip
def test_before_its_entry_nothing_depends_on_an_agent(seed, count, late, unicycle):
    """Agents that enter in four steps are added to a world, on places where others are."""
    drawn = random_world(seed, count, unicycle=unicycle, radius=0.2)
    crew = drawn.agents
    index = np.concatenate([np.arange(count), np.arange(late) % count])
    more = Agents(**{f.name: getattr(crew, f.name)[index] for f in fields(Agents)})
    enters = np.concatenate([np.zeros(count), np.full(late, 4 * DT)])
    both = replace(drawn, agents=replace(more, enters=enters))
    chosen = np.arange(count)[None]
    pairs = zip(run(drawn, 5, seed), run(both, 5, seed), strict=True)
    for k, (alone, beside) in enumerate(pairs):
        if k < 4:
            assert readings(alone, chosen) == readings(beside, chosen)
            assert not beside.present[0, count:].any()


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 10_000), st.sampled_from([3, 30]))
def test_an_entry_time_of_zero_changes_no_bit(seed, count):
    drawn = random_world(seed, count, radius=0.2)
    chosen = np.arange(count)[None]
    for left, right in zip(run(drawn, 6, seed), run(entering(drawn, 0.0), 6, seed), strict=True):
        assert readings(left, chosen) == readings(right, chosen)


def test_a_crowd_that_enters_is_a_crowd_by_brute_force(monkeypatch):
    """More than `BRUTE_FORCE` agents use cells, whose spots change when agents enter."""
    drawn = entering(random_world(2, 30, radius=0.2), np.linspace(0.0, 4.0, 30))
    twins = [s.position[0].copy() for s in run(drawn, 30)]
    slow = Twin(drawn)
    rng = np.random.default_rng(0)
    for place in twins[1:]:
        command = rng.normal(size=(1, 64, 2))[0, :30] * 2.0
        slow.step(command, np.zeros(30, bool))
        np.testing.assert_allclose(slow.position, place, atol=1e-7)
        slow.position = place.copy()
