"""Bodies that appear and vanish within an episode: contacts, sensors, metrics, the slow twin."""

import math

import numpy as np
import pytest

from benchnav.arena.body import Body, absent
from benchnav.arena.noise import NeighbourNoise, Noise, RayNoise
from benchnav.arena.solid import Kind
from benchnav.generation.motion_law import swept, track_law
from benchnav.metrics.quantities.encounters import encounters, things_of
from benchnav.metrics.quantities.trajectory import Trajectories
from benchnav.sensors.sense import sense
from benchnav.verify.reference.reference_geometry import law_position
from benchnav.verify.reference.reference_simulator import Twin
from benchnav.world.simulation import Simulation
from tests.sensors.noisy import NEEDS, active, noisy
from tests.worlds import agents, disc, world

DT = 0.2


def person(times, points, radius=0.3):
    law = track_law(np.array(times, float), np.array(points, float), present=True)
    return Body(disc(Kind.DYNAMIC, 0.0, 0.0, radius), law)


def stepped(here, command=(0.0, 0.0), steps=30):
    """The simulation after each step, and the slow twin beside it."""
    simulation, twin = Simulation([here]), Twin(here)
    motion = np.broadcast_to(np.array(command, float), (1, len(here.agents), 2)).copy()
    twist = np.zeros((1, len(here.agents)), bool)
    for _ in range(steps):
        simulation.step(motion, twist)
        twin.step(motion[0], twist[0])
        np.testing.assert_allclose(simulation.body_position[0], twin.bodies, atol=1e-9)
        np.testing.assert_allclose(simulation.position[0], twin.position, atol=1e-9)
        yield simulation


def test_a_body_is_there_from_its_first_to_its_last_time():
    here = world(agents([2, 2], [18, 18]), bodies=[person([1.0, 3.0], [[5, 5], [7, 5]])])
    assert absent(Simulation([here]).body_position[0]).all()
    states = [s.body_position[0, 0].copy() for s in stepped(here)]
    for k, place in enumerate(states, 1):
        time = k * DT
        if 1.0 - 1e-9 <= time <= 3.0 + 1e-9:
            np.testing.assert_allclose(place, [5 + (time - 1.0), 5], atol=1e-9)
        else:
            assert absent(place)


def test_a_law_with_presence_has_rising_times_and_sweeps_only_its_path():
    for first in (0.0, 0.4):
        law = person([first, first + 1.0], [[5, 5], [6, 5]]).law
        assert law.times[0] == 0.0
        assert (np.diff(law.times) > 0.0).all()
        path = swept(law, 0.3)
        assert path[:, [0, 2]].min() == 5.0
        assert path[:, [0, 2]].max() == 6.0


def test_it_hits_only_while_it_is_there():
    """An agent stands where a person walks past later, and where another was before."""
    walk = [[4, 10], [16, 10]]
    crew = agents([10, 10], [18, 18])
    (event,) = contacts(world(crew, bodies=[person([1.0, 5.0], walk)]))
    assert 1.0 < event < 5.0
    # it vanishes before it reaches the agent, and another appears behind it
    assert not contacts(world(crew, bodies=[person([0.0, 1.0], [[4, 10], [9, 10]])]))
    assert not contacts(world(crew, bodies=[person([1.0, 2.0], [[11, 10], [16, 10]])]))


def contacts(here):
    *_, last = stepped(here)
    found = last.contacts(0)
    return found.start.tolist()


def test_it_appears_and_vanishes_without_travelling():
    """Agents between a person and the place far outside, where absent bodies are, feel nothing."""
    crew = agents([[6, 6], [12, 12], [4, 5], [15, 15]], [[18, 1], [18, 2], [18, 3], [1, 18]])
    assert not contacts(world(crew, bodies=[person([1.0, 3.0], [[5, 5], [5, 5]], radius=0.2)]))


def test_a_person_that_appears_on_an_agent_is_a_contact_if_they_approach():
    crew = agents([5, 5], [18, 18])
    assert not contacts(world(crew, bodies=[person([1.0, 3.0], [[5.2, 5], [5.9, 5]])]))
    here = world(crew, bodies=[person([1.0, 3.0], [[5.5, 5], [5.2, 5]])])
    *_, last = stepped(here)
    found = last.contacts(0)
    assert len(found) == 1
    assert 1.0 <= found.start[0] <= 1.0 + DT
    assert 3.0 <= found.end[0] <= 3.0 + DT


def test_sensors_do_not_see_what_is_absent():
    here = world(agents([5, 5], [18, 5]), bodies=[person([1.0, 3.0], [[8, 5], [8, 5]])])
    seen = {}
    for k, simulation in enumerate(stepped(here), 1):
        needs = frozenset(("rays", "neighbours"))
        rays, neighbours, _ = sense(simulation, np.array([[0]]), needs)
        seen[round(k * DT, 6)] = (
            int(neighbours.count[0, 0]),
            bool((rays.kind[0, 0] == int(Kind.DYNAMIC)).any()),
        )
    assert seen[0.6] == (0, False)
    assert seen[2.0] == (1, True)
    assert seen[4.0] == (0, False)


CAPSULE = {"half_length": 0.5, "half_width": 0.2, "rounding": 0.2}


@pytest.mark.parametrize("shape", [{}, CAPSULE], ids=["discs", "capsules"])
@pytest.mark.parametrize("seed", range(4))
def test_the_twin_agrees_on_random_crowds(seed, shape):
    rng = np.random.default_rng(seed)
    people = []
    for _ in range(8):
        first = rng.uniform(0.0, 3.0)
        times = first + np.concatenate([[0.0], np.cumsum(rng.uniform(0.3, 1.0, 4))])
        people.append(person(times, rng.uniform(3, 17, (5, 2))))
    crew = agents(rng.uniform(3, 17, (3, 2)), rng.uniform(3, 17, (3, 2)), **shape)
    here = world(crew, bodies=people)
    for _ in stepped(here, command=rng.uniform(-1, 1, 2), steps=25):
        pass
    for body in people:
        for time in rng.uniform(0.0, 6.0, 20):
            here = body.law.times[2] <= time <= body.law.times[-2]
            assert absent(law_position(body, time, False)) == (not here)


def test_noisy_senses_invent_nobody_for_what_is_absent():
    """The noise of a reading is that of an object which is there."""
    noise = Noise(
        RayNoise(0.05, 0.05, 0.01, 0.0, 0.0), NeighbourNoise(0.3, 0.3, 0.3, 0.0, 4.0), delay=1
    )
    here = world(agents([5, 5], [18, 5]), bodies=[person([1.0, 3.0], [[8, 5], [8, 5]])])
    simulation, senses = noisy([here], noise)
    seen = {}
    for k in range(25):
        rays, neighbours, _ = senses.sense(active(simulation, senses), NEEDS)
        dynamic = bool((rays.kind[0, 0] == int(Kind.DYNAMIC)).any())
        seen[round(k * DT, 6)] = int(neighbours.count[0, 0]), dynamic
        assert np.isfinite(neighbours.position[0, 0]).all()
        assert np.abs(neighbours.position[0, 0]).max() < 20.0
        simulation.step(np.zeros((1, 1, 2)), np.zeros((1, 1), bool))
    assert seen[0.8] == seen[1.0] == (0, False)  # one decision late
    assert seen[2.0] == seen[3.0] == (1, True)
    assert seen[4.0] == (0, False)


def trajectories(position):
    states = len(position)
    steps = states - 1
    velocity = np.diff(position, axis=0)[None] / DT
    return Trajectories(
        DT, np.array([steps]), np.array([steps * DT]), position[None].copy(),
        np.full((1, steps), DT), velocity, np.array([states]), np.array([1.0]), np.array([True]),
    )  # fmt: skip


def test_clearance_counts_a_person_while_it_is_there():
    here = world(agents([5, 5], [18, 5], radius=0.3), bodies=[person([1.0, 2.0], [[8, 5], [8, 5]])])
    times = np.arange(16) * DT
    position = np.column_stack([2.0 + times, np.full(16, 5.0)])
    bodies = np.array([[law_position(here.bodies[0], t, False)] for t in times])
    found = encounters(trajectories(position), np.array([0.3]), things_of(here, bodies))
    # until it vanishes between 2.0 and 2.2 s, the agent is 4.0 to 4.2 m along
    assert found.clearance[0] == pytest.approx(8.0 - 4.2 - 0.6, abs=1e-9)
    assert found.time_to_collision[0] == pytest.approx(8.0 - 4.2 - 0.6, abs=1e-6)
    shape = np.array([[0.3, 0.0, 0.2]]), np.zeros((1, 16))  # 0.5 m ahead of its centre
    ahead = encounters(trajectories(position), np.array([0.5]), things_of(here, bodies), shape)
    assert ahead.clearance[0] == pytest.approx(8.0 - 4.15 - 0.8, abs=1e-9)  # at a quarter of a step
    away = np.broadcast_to(np.array([1e7, 1e7]), bodies.shape)
    nothing = encounters(trajectories(position), np.array([0.3]), things_of(here, away))
    assert nothing.clearance[0] == math.inf
    none = encounters(trajectories(position), np.array([0.5]), things_of(here, away), shape)
    assert none.clearance[0] == math.inf
