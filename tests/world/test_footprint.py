"""Bodies that are not discs: contacts while they move and turn, against shapely."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity

from benchnav.arena.solid import Kind
from benchnav.arena.world import Afterwards, ContactRule
from benchnav.episode.episode import Status
from benchnav.verify.reference.reference_simulator import Twin
from benchnav.world.simulation import Simulation
from benchnav.world.touch import BRUTE_FORCE
from tests import worlds

MOST = BRUTE_FORCE + 6  # agents of a world here
DEEPEST = 1e-8  # [m] allowed overlap with anything that yields or stands: rounding


def shaped(crew, shapes):
    """Return the crew with footprints (A, 3): half length, half width, rounding [m]."""
    length, width, corner = np.broadcast_to(np.asarray(shapes, float), (len(crew), 3)).T
    radius = np.hypot(length - corner, width - corner) + corner
    return replace(crew, radius=radius, half_length=length, half_width=width, rounding=corner)


def core(agents, i, position, heading):
    """Return (core of agent i as a shape of shapely, radius [m] around it)."""
    if agents.rounding[i] == 0.0:
        return shapely.Point(position), agents.radius[i]
    x = agents.half_length[i] - agents.rounding[i]
    y = agents.half_width[i] - agents.rounding[i]
    box = shapely.MultiPoint([(-x, -y), (x, -y), (x, y), (-x, y)]).convex_hull
    turned = affinity.rotate(box, heading, origin=(0, 0), use_radians=True)
    return affinity.translate(turned, *position), agents.rounding[i]


def fixed_core(solid):
    if solid.is_disc:
        return shapely.Point(solid.center), solid.radius
    return shapely.MultiLineString([[*loop, loop[0]] for loop in solid.loops]), 0.0


def deepest(world, simulation, b=0):
    """Return the deepest overlap [m] of agents with each other and with fixed solids.

    It is exact up to the depth at which cores meet.
    """
    present = np.flatnonzero(simulation.present[b])
    cores = {
        i: core(world.agents, i, simulation.position[b, i], simulation.heading[b, i])
        for i in present
    }
    fixed = [fixed_core(solid) for solid in world.solids]
    worst = -math.inf
    for i in present:
        shape, radius = cores[i]
        for other, reach in [*(cores[j] for j in present if j > i), *fixed]:
            worst = max(worst, radius + reach - shape.distance(other))
    return worst


SHAPES = [(0.6, 0.2, 0.2), (0.5, 0.4, 0.05), (0.3, 0.45, 0.1), (0.4, 0.4, 0.4), (0.8, 0.1, 0.1)]


def crowded(seed, count=4, contact=ContactRule.SLIDE, **options):
    """Return a small walled world, full of boxes, discs and long bodies."""
    rng = np.random.default_rng(seed)
    base = worlds.random_world(seed, count, radius=0.85, contact=contact, **options)
    shapes = [SHAPES[k] for k in rng.integers(len(SHAPES), size=count)]
    return replace(base, agents=shaped(base.agents, shapes), bodies=())


def drive(simulation, rng, steps, twist=None):
    """Yield after each of some steps with random commands that last a while."""
    shape = simulation.position.shape
    for t in range(steps):
        if t % 6 == 0:
            command = rng.normal(0.0, 2.0, shape)
            twisted = rng.random(shape[:2]) < 0.5 if twist is None else np.full(shape[:2], twist)
            command[twisted] = np.abs(command[twisted]) * [1.0, 1.0]
            command[..., 1] *= np.where(twisted, rng.choice([-1.0, 1.0], shape[:2]), 1.0)
        simulation.step(command, twisted)
        yield t


@pytest.mark.parametrize("rule", list(ContactRule))
@settings(max_examples=12, deadline=None)
@given(st.integers(0, 10**6), st.booleans())
def test_no_body_penetrates_whatever_the_commands(rule, seed, unicycle):
    world = crowded(seed, 5, rule, unicycle=unicycle, side=20.0, on_end=Afterwards.STAY)
    simulation = Simulation([world])
    assert deepest(world, simulation) <= 0.0
    for _ in drive(simulation, np.random.default_rng(seed), 40):
        assert deepest(world, simulation) < DEEPEST


def test_a_body_flat_along_a_wall_can_turn_away():
    crew = shaped(worlds.agents([[5.0, 0.25]], [[15.0, 15.0]], unicycle=True), (0.6, 0.2, 0.2))
    world = worlds.world(crew, [worlds.walls(20.0)])
    simulation = Simulation([world])
    for _ in range(5):
        simulation.step(np.array([[[0.0, 1.0]]]), np.ones((1, 1), bool))
    assert simulation.heading[0, 0] == pytest.approx(1.0)
    assert deepest(world, simulation) < DEEPEST
    # it gave way by as much as its rear end needed
    assert simulation.position[0, 0, 1] == pytest.approx(0.2 + 0.4 * math.sin(1.0), abs=1e-6)
    contacts = simulation.contacts(0)
    assert contacts.kind.tolist() == [Kind.WALL]
    assert contacts.closing_speed[0] > 0.1


def test_a_body_that_has_no_room_to_give_way_does_not_turn():
    crew = shaped(worlds.agents([[5.0, 0.25]], [[15.0, 15.0]], unicycle=True), (0.6, 0.2, 0.2))
    lid = worlds.box(Kind.WALL, 5.0, 1.0, 4.0, 0.5)  # leaves a slot of 0.5 m
    world = worlds.world(crew, [worlds.walls(20.0), lid])
    simulation = Simulation([world])
    for _ in range(20):
        simulation.step(np.array([[[0.0, 1.0]]]), np.ones((1, 1), bool))
        assert deepest(world, simulation) < DEEPEST
    most = math.asin(0.1 / 0.8)  # both ends touch, 0.5 m apart in all
    assert simulation.heading[0, 0] == pytest.approx(most, abs=2 * 0.005 / 0.4)


@pytest.mark.parametrize("rule", [ContactRule.STOP, ContactRule.END])
def test_a_turn_into_a_wall_stops_or_ends_the_attempt(rule):
    crew = shaped(worlds.agents([[5.0, 0.5]], [[15.0, 15.0]], unicycle=True), (0.6, 0.2, 0.2))
    world = worlds.world(crew, [worlds.walls(20.0)], contact=rule, on_end=Afterwards.STAY)
    simulation = Simulation([world])
    for _ in range(10):
        simulation.step(np.array([[[0.0, 1.0]]]), np.ones((1, 1), bool))
    assert deepest(world, simulation) < DEEPEST
    assert len(simulation.contacts(0)) == 1
    ended = simulation.status[0, 0] == int(Status.ENDED)
    assert ended == (rule == ContactRule.END)
    assert 0.0 < simulation.heading[0, 0] < math.asin(0.3 / 0.4)


def test_a_holonomic_body_turns_to_its_direction_at_its_turn_rate():
    crew = shaped(worlds.agents([[5.0, 5.0]], [[15.0, 15.0]]), (0.6, 0.2, 0.2))
    simulation = Simulation([worlds.world(crew, dt=0.2)])
    simulation.step(np.array([[[0.0, 1.0]]]), np.zeros((1, 1), bool))
    assert simulation.heading[0, 0] == pytest.approx(0.5)
    for _ in range(5):
        simulation.step(np.array([[[0.0, 1.0]]]), np.zeros((1, 1), bool))
    assert simulation.heading[0, 0] == pytest.approx(math.pi / 2)


def states(worlds_, seed, steps=30):
    """Return positions and headings of all steps, with equal commands in equal worlds."""
    simulation = Simulation(worlds_)
    rngs = [np.random.default_rng(seed + b) for b in range(len(worlds_))]
    out = []
    twist = np.zeros(simulation.position.shape[:2], bool)
    twist[:, ::2] = True
    for _ in range(steps):
        command = np.stack([rng.normal(0.0, 2.0, (MOST, 2))[: simulation.A] for rng in rngs])
        command[twist] = np.abs(command[twist])
        simulation.step(command, twist)
        out.append(np.concatenate([simulation.position, simulation.heading[..., None]], axis=-1))
    return np.array(out)


def test_a_capsule_as_long_as_wide_is_a_disc_bit_for_bit():
    base = worlds.random_world(7, 6)
    round_ = replace(base, agents=shaped(base.agents, (0.5, 0.5, 0.5)))
    assert (states([base], 3) == states([round_], 3)).all()


def test_bits_do_not_depend_on_the_batch():
    batch = [crowded(seed, 6) for seed in range(3)]
    together = states(batch, 11)
    for b, world in enumerate(batch):
        assert (states([world], 11 + b)[:, 0] == together[:, b]).all()


@pytest.mark.parametrize(
    ("threads", "rule"),
    [("1", ContactRule.SLIDE), ("3", ContactRule.SLIDE), ("2", ContactRule.STOP)],
)
def test_bits_are_those_of_a_crowd_and_do_not_depend_on_threads(threads, rule, monkeypatch):
    """In a batch with a crowd, bodies find each other by cells; alone, they test all pairs."""
    batch = [crowded(seed, 20, rule, side=9.0) for seed in range(3)]
    alone = [states([world], 11 + b)[:, 0] for b, world in enumerate(batch)]
    turned = sum((np.abs(np.diff(path[..., 2], axis=0)) > 0.0).sum() for path in alone)
    assert turned > 100
    monkeypatch.setenv("BENCHNAV_THREADS", threads)
    together = states([*batch, crowded(5, MOST, rule, side=14.0)], 11)
    for b, path in enumerate(alone):
        assert (path == together[:, b, :20]).all()


def test_a_crowd_of_long_bodies_penetrates_nothing():
    rng = np.random.default_rng(5)
    start = np.stack(np.meshgrid(np.arange(6), np.arange(5)), axis=-1).reshape(-1, 2) * 1.7 + 2.0
    crew = worlds.agents(start, start[::-1].copy(), 0.85, heading=rng.uniform(-3, 3, 30))
    shapes = [SHAPES[k] for k in rng.integers(len(SHAPES), size=30)]
    world = worlds.world(shaped(crew, shapes), [worlds.walls(12.0)], side=12.0)
    simulation = Simulation([world])
    for _ in range(40):
        command = 2.0 * (simulation.goal - simulation.position)
        simulation.step(command, np.zeros((1, 30), bool))
        assert deepest(world, simulation) < DEEPEST
    assert (simulation.contacts(0).kind == int(Kind.AGENT)).sum() > 10


@pytest.mark.parametrize("seed", range(6))
def test_decisions_are_those_of_the_slow_twin(seed):
    world = crowded(seed, 4, list(ContactRule)[seed % 3], on_end=Afterwards.STAY)
    movers = worlds.random_world(seed, 4, radius=0.85).bodies
    world = replace(world, bodies=movers)
    simulation, twin = Simulation([world]), Twin(world)
    rng, compared = np.random.default_rng(seed), 0
    twist = np.array([True, False, True, False])
    command = rng.normal(0.0, 2.0, (1, 4, 2))
    for t in range(30):
        if t % 6 == 0:
            command = rng.normal(0.0, 2.0, (1, 4, 2))
            command[0, twist, 0] = np.abs(command[0, twist, 0])
        simulation.step(command, twist[None])
        twin.step(command[0], twist)
        if not twin.doubtful:
            compared += 1
            assert simulation.position[0] == pytest.approx(twin.position, abs=1e-7)
            turned = np.remainder(simulation.heading[0] - twin.heading + 3.0, 2 * math.pi) - 3.0
            assert turned[simulation.present[0]] == pytest.approx(0.0, abs=1e-7)
        twin.position = simulation.position[0].copy()
        twin.heading = simulation.heading[0].copy()
        twin.status = simulation.status[0].copy()
    assert compared > 15
