"""Touches within a crowd against their slow twins: every pair, plain loops, no cells."""

import math

import numpy as np
import pytest

from benchnav.arena.sensing import NeighbourSensor, Sensing
from benchnav.arena.solid import Kind
from benchnav.arena.world import ContactRule
from benchnav.geometry.hash_grid import fill, follow, hash_table
from benchnav.sensors.sense import sense
from benchnav.world import step
from benchnav.world.crowd import (
    ROWS,
    TAU,
    X,
    Y,
    earliest,
    listed_agent,
    near_either,
    next_agent,
)
from benchnav.world.records import AGENT, LISTED, SPOT
from benchnav.world.simulation import Simulation
from benchnav.world.touch import pair_time
from tests.worlds import agents, box, random_world, world

COUNT, H, WIDEST = 300, 0.5, 0.3
SIDES = (0.4, 1.1, 3.0)  # [m] of cells


@pytest.fixture
def crowd():
    """Agents, some at one place and some absent."""
    rng = np.random.default_rng(3)
    crowd = np.zeros(COUNT, AGENT)
    crowd["x"], crowd["y"] = rng.uniform(-12.0, 12.0, (2, COUNT))
    crowd["vx"], crowd["vy"] = rng.normal(0.0, 0.5, (2, COUNT))
    crowd["radius"] = rng.uniform(0.1, WIDEST, COUNT)
    crowd["x"][1:9], crowd["y"][1:9] = crowd["x"][0], crowd["y"][0]
    crowd["present"] = rng.random(COUNT) < 0.9
    return crowd


def sorted_into(crowd, side):
    """Return (hashed, spots, motion) of a crowd."""
    hashed, spots = hash_table(1, COUNT)[0], np.zeros(COUNT, SPOT)
    fill(crowd, hashed, spots, side)
    motion = np.full((ROWS, COUNT), math.inf)
    for row, name in enumerate(("x", "y", "vx", "vy", "radius")):
        motion[row] = spots[name]
    return hashed, spots, motion


def first_of_all(crowd, i, left):
    """Return (time, index) of the first agent that i touches, from all pairs."""
    times = [
        (pair_time(crowd[i], crowd[j]), j) for j in range(COUNT) if j != i and crowd["present"][j]
    ]
    return min([(t, j) for t, j in times if t <= left], default=(math.inf, -1))


@pytest.mark.parametrize("side", SIDES)
def test_cells_find_the_first_touch(crowd, side):
    hashed, spots, motion = sorted_into(crowd, side)
    speed = np.hypot(crowd["vx"], crowd["vy"])
    near, touches = np.empty(COUNT + 1, np.int64), 0
    for own in range(hashed[-1]):
        i = spots["index"][own]
        reach = crowd["radius"][i] + WIDEST + 1.001 * (speed[i] + speed.max()) * H
        found = next_agent(own, H, reach, side, False, crowd, hashed, spots, motion, near)
        assert found == first_of_all(crowd, i, H)
        touches += found[1] >= 0
    assert 50 < touches < 300


def test_lists_find_the_first_touch(crowd):
    """A list is enough for agents whose reach ends before the last one listed."""
    hashed, spots, motion = sorted_into(crowd, 1.0)
    here = spots[: hashed[-1]]
    speed = np.hypot(crowd["vx"], crowd["vy"])
    touches = 0
    for own in range(hashed[-1]):
        i = here["index"][own]
        distance = np.hypot(here["x"] - crowd["x"][i], here["y"] - crowd["y"][i])
        order = np.argsort(distance)
        order = order[order != own][:LISTED]
        way = 1.001 * (speed[i] + speed.max()) * H
        if crowd["radius"][i] + WIDEST + way > distance[order[-1]]:
            continue
        listed = np.array([LISTED, *order], np.int32)
        found = listed_agent(own, H, way, WIDEST, False, crowd, spots, listed, motion)
        assert found == first_of_all(crowd, i, H)
        touches += found[1] >= 0
    assert touches > 30


def test_spots_follow_agents_that_only_changed_their_velocities(crowd):
    hashed, spots, _ = sorted_into(crowd, 1.0)
    crowd["vx"] *= 2.0
    assert follow(crowd, hashed, spots)
    here = spots[: hashed[-1]]
    assert here["vx"].tolist() == crowd["vx"][here["index"]].tolist()
    for name, value in (("x", 3.0), ("radius", 0.4), ("present", False)):
        other = crowd.copy()
        other[name][here["index"][7]] = value
        assert not follow(other, hashed, spots)
    more = crowd.copy()
    more["present"] = True
    assert not follow(more, hashed, spots)


def test_the_earliest_touch_and_the_agents_near_it(crowd):
    hashed, spots, motion = sorted_into(crowd, 1.0)
    rng, count, near = np.random.default_rng(4), hashed[-1], np.empty(COUNT + 1, np.int64)
    assert earliest(count, spots, motion) == -1
    for _ in range(200):
        motion[TAU] = rng.integers(0, 40, COUNT) / 8.0  # often equal
        index = spots["index"][:count]
        expected = np.lexsort((index, motion[TAU, :count]))[0]
        assert earliest(count, spots, motion) == expected
        a, b = rng.integers(0, count, 2)
        x, y = motion[X, :count], motion[Y, :count]
        close = [(x - x[k]) * (x - x[k]) + (y - y[k]) * (y - y[k]) < 1.7 * 1.7 for k in (a, b)]
        found = near[: near_either(a, b, count, 1.7, motion, near)]
        assert found.tolist() == np.flatnonzero(close[0] | close[1]).tolist()


@pytest.mark.parametrize("contact", list(ContactRule))
def test_a_crowd_steps_as_a_few_agents_do(contact, monkeypatch):
    """The step that tests all pairs gives the same bits, among walls and dynamic obstacles."""
    worlds = [random_world(seed, 28, contact, False, radius=0.4) for seed in range(2)]
    seen = []
    for few in (False, True):
        if few:  # after the other one was compiled
            step_for_few(monkeypatch)
        simulation = Simulation(worlds)
        rng = np.random.default_rng(1)
        for _ in range(8):
            command = rng.normal(size=(2, 28, 2)) * 2.0
            simulation.step(command, np.zeros((2, 28), bool))
        events = [simulation.contacts(b) for b in range(2)]
        assert sum(map(len, events)) > 20
        seen.append(
            [getattr(simulation, name).tobytes() for name in ("position", "velocity", "status")]
            + [event.start.tobytes() for event in events]
        )
    assert seen[0] == seen[1]


def step_for_few(monkeypatch):
    """Let Python run the step, with the branch for a few agents."""
    monkeypatch.setattr(step, "BRUTE_FORCE", 1000)
    for name in ("_step_rows", "step_world"):
        monkeypatch.setattr(step, name, getattr(step, name).py_func)
    monkeypatch.setattr("benchnav.world.simulation.step_worlds", step.step_worlds.py_func)


def test_lists_of_the_nearest_change_no_step():
    """Sensing before a step leaves its table to it, also if agents are moved in between."""
    rng = np.random.default_rng(5)
    start = rng.uniform(1.0, 19.0, (200, 2))
    sensing = Sensing(None, NeighbourSensor(10, 6.0), None)
    crew = agents(start, start[::-1])
    everyone = np.arange(200)[None]
    for solids in ([], [box(Kind.WALL, 10.0, 10.0, 1.0, 2.0)]):
        blind, seeing = (Simulation([world(crew, solids, sensing=sensing)]) for _ in range(2))
        for k in range(30):
            command = rng.normal(size=(1, 200, 2))
            sense(seeing, np.where(seeing.present, everyone, -1), frozenset({"neighbours"}))
            for simulation in (blind, seeing):
                if k % 5 == 4:
                    simulation.position[0, k] = simulation.position[0, k + 1] + 0.7
                simulation.step(command, np.zeros((1, 200), bool))
            assert blind.position.tobytes() == seeing.position.tobytes()
            assert blind.velocity.tobytes() == seeing.velocity.tobytes()
        assert len(seeing.contacts(0)) > 50
        assert blind.contacts(0).start.tobytes() == seeing.contacts(0).start.tobytes()
