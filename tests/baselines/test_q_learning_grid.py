from dataclasses import replace

import numpy as np
import pytest
from benchnav_baselines.learned.q_learning.cells import STEPS, lay_cells
from benchnav_baselines.learned.q_learning.grid import QLearningGrid
from benchnav_baselines.learned.q_learning.grid_learner import (
    Schooling,
    best_moves,
    episodes,
    first_values,
    follow,
    learn,
    next_cells,
)

from benchnav.arena.solid import Kind, Solid
from benchnav.errors import ConfigError
from benchnav.geometry.sweep import clearance, motion_is_free
from benchnav.navigation.map import Map
from benchnav.navigation.observation import Observation
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import NAVIGATORS
from benchnav.testing.check_navigator import check_navigator
from tests.baselines.crowds import answers, briefing

SQUARE = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
BOUNDS = (-5.0, -5.0, 5.0, 5.0)


def walled(*boxes, revision=0):
    """A map of 10 m with square boxes (x, y, half side)."""
    wall = Solid(Kind.WALL, (5.0 * SQUARE[::-1],))
    return Map(
        BOUNDS, (wall, *(Solid(Kind.STATIC, (h * SQUARE + (x, y),)) for x, y, h in boxes)), revision
    )


def view(place, goal, map, velocity=None):
    place = np.array(place, float)[None]
    return Observation(
        rows=np.zeros(1, np.int64),
        time=np.zeros(1),
        active=np.ones(place.shape[:2], bool),
        position=place,
        heading=np.zeros(place.shape[:2]),
        velocity=np.zeros(place.shape),
        goal=np.array(goal, float)[None],
        maps=(map,),
    )


def walk(navigator, told, maps, steps=200):
    """(T, A, 2) where holonomic agents go that obey; the map of a step is ``maps(step)``."""
    place, way = told.start.copy(), [told.start.copy()]
    for step in range(steps):
        command = navigator.act(view(place, told.goal, maps(step)))[0]
        place = place + told.dt * command
        way.append(place.copy())
    return np.array(way)


def test_it_is_a_navigator():
    check_navigator(lambda: QLearningGrid(QLearningGrid.Config(cell=0.5, decisions=4_000)))


def test_moves_are_those_of_a_slow_twin():
    boxes = [(0.41, 0.33, 1.1), (-2.07, 3.04, 0.7)]
    map = walled(*boxes)
    cells = lay_cells(map, 0.7, 0.4, 0.1)
    nx = int(np.sum(cells.centre[:, 1] == cells.centre[0, 1]))
    blocked = 0
    for n, here in enumerate(cells.centre):
        inside = any(np.abs(here - (x, y)).max() < half for x, y, half in boxes)
        for m, step in enumerate(STEPS):
            there = here + 0.7 * step
            i, j = n % nx + step[0], n // nx + step[1]
            exists = 0 <= i < nx and 0 <= j < len(cells.centre) // nx
            free = exists and not inside and motion_is_free(*here, *there, 0.5, map.capsules)
            assert (cells.after[n, m] >= 0) == free
            blocked += exists and not free
            if free:
                np.testing.assert_allclose(cells.centre[cells.after[n, m]], there, atol=1e-12)
    assert blocked > 20


def slow_episodes(values, after, cost, over, begin, noise, explore, rate, longest):
    """The update as the books print it, one move at a time."""
    noise = iter(noise)
    for cell in begin:
        for _ in range(longest):
            u = None if over[cell] else next(noise, None)
            if u is None:
                break
            move = int(np.argmax(values[cell]))
            if u < explore and after[cell, int(u / explore * 8)] >= 0:
                move = int(u / explore * 8)
            then = after[cell, move]
            target = -cost[move] + values[then].max()
            values[cell, move] = (1 - rate) * values[cell, move] + rate * target
            cell = then


def test_learning_equals_a_slow_twin():
    cells = lay_cells(walled((0.0, 0.0, 1.5)), 0.5, 0.3, 0.0)
    goal, rng = np.array([4.0, 0.0]), np.random.default_rng(3)
    over = np.zeros(len(cells.centre), bool)
    over[cells.joined(goal, 0.75)] = True
    begin = rng.choice(np.flatnonzero((cells.after >= 0).any(axis=1)), 400)
    noise = rng.random(6000)
    fast, slow = first_values(cells, goal), first_values(cells, goal)
    fast[over] = slow[over] = 0.0
    link, top = best_moves(fast, cells.after, np.flatnonzero(over))
    episodes(fast, link, top, cells.after, cells.cost, begin, noise, 0.3, 0.5, 60)
    slow_episodes(slow, cells.after, cells.cost, over, begin, noise, 0.3, 0.5, 60)
    moved = (cells.after >= 0) & ~over[:, None]
    assert np.abs(fast[moved] - first_values(cells, goal)[moved]).max() > 0.5
    np.testing.assert_allclose(fast, slow, atol=1e-12)
    best, every = fast.argmax(axis=1), np.arange(len(fast))
    ahead = np.where(over, -1, cells.after[every, best])
    np.testing.assert_array_equal(top, fast[every, best])
    np.testing.assert_array_equal(next_cells(link), ahead)
    np.testing.assert_array_equal(link[ahead >= 0] & 7, best[ahead >= 0])


def test_the_learned_way_is_the_shortest_on_the_grid():
    cells = lay_cells(walled((0.0, 0.0, 2.0), (3.0, 3.2, 0.6)), 0.5, 0.3, 0.1)
    goal = np.array([4.2, 0.3])
    ends = cells.joined(goal, 0.75)
    over = np.zeros(len(cells.centre), bool)
    over[ends] = True
    start = int(cells.joined(np.array([-4.2, -0.2]), 0.8)[0])
    how = Schooling(100_000, 0.1, 1.0)
    values, after = learn(cells, ends, goal, start, how, np.random.default_rng(0))
    assert follow(after, over, start) > 0
    exact = np.where(over, 0.0, np.inf)
    for _ in range(200):  # Bellman's equation, until nothing changes
        way = np.where(cells.after >= 0, cells.cost + exact[cells.after], np.inf)
        exact = np.where(over, 0.0, way.min(axis=1))
    assert -values[start].max() == pytest.approx(exact[start])
    known = np.isfinite(exact) & ~over
    assert (-values[known].max(axis=1) <= exact[known] + 1e-9).all()  # never too low


def test_it_goes_round_a_box_and_clear_of_it():
    map = walled((0.0, 0.0, 1.5))
    told = briefing([(-4.0, 0.1), (0.3, 4.0)], [(4.0, 0.2), (0.1, -4.0)], map=map)
    navigator = QLearningGrid()
    navigator.reset([told], np.zeros(1, np.int64))
    way = walk(navigator, told, lambda step: map)
    np.testing.assert_allclose(way[-1], told.goal, atol=1e-6)
    gaps = [clearance(x, y, map.capsules) for x, y in way.reshape(-1, 2)]
    assert min(gaps) > 0.3


def test_what_it_learned_does_not_fit_where_the_box_was_moved():
    stale, now = walled((0.0, 3.0, 1.0)), walled((0.0, 0.0, 1.0))
    gaps = {}
    for name, map in (("stale", stale), ("known", now)):
        told = briefing([(-4.0, 0.0)], [(4.0, 0.0)], map=map)
        navigator = QLearningGrid()
        navigator.reset([told], np.zeros(1, np.int64))
        way = walk(navigator, told, lambda step, shown=map: shown)
        gaps[name] = min(clearance(x, y, now.capsules) for x, y in way.reshape(-1, 2))
    assert gaps["stale"] < 0.25
    assert gaps["known"] > 0.3


def test_it_learns_anew_when_the_revision_rises_and_only_then():
    before, after = walled((0.0, 3.0, 1.0)), walled((0.0, 0.0, 1.0), revision=1)
    told = briefing([(-4.0, 0.0)], [(4.0, 0.0)], map=before)
    navigator = QLearningGrid()
    navigator.reset([told], np.zeros(1, np.int64))
    way = walk(navigator, told, lambda step: after if step > 5 else before)
    assert min(clearance(x, y, after.capsules) for x, y in way[:, 0]) > 0.3
    np.testing.assert_allclose(way[-1], told.goal, atol=1e-6)
    navigator.reset([replace(told, map=before)], np.zeros(1, np.int64))
    unseen = replace(after, revision=0)  # moved, and nobody says so
    way = walk(navigator, told, lambda step: unseen)
    assert min(clearance(x, y, after.capsules) for x, y in way[:, 0]) < 0.25


def test_without_a_way_it_heads_for_the_goal():
    closed = walled(*[(x, 0.0, 1.0) for x in (-4.0, -2.0, 0.0, 2.0, 4.0)])
    told = briefing([(0.0, -3.0)], [(0.0, 3.0)], map=closed)
    command = answers(QLearningGrid(), [told], view(told.start, told.goal, closed))
    np.testing.assert_allclose(command, [[[0.0, 1.0]]])


def test_a_narrow_gap_is_taken_with_less_clearance():
    map = walled((-2.7, 0.0, 2.3), (2.7, 0.0, 2.3))  # 0.8 m wide, the disc 0.6
    told = briefing([(0.0, -4.0)], [(0.0, 4.0)], map=map)
    navigator = QLearningGrid(QLearningGrid.Config(cell=0.2))
    navigator.reset([told], np.zeros(1, np.int64))
    way = walk(navigator, told, lambda step: map)
    np.testing.assert_allclose(way[-1], told.goal, atol=1e-6)


def test_wrong_parameters_are_refused():
    spec = {"type": "benchnav_baselines.learned.q_learning.grid:QLearningGrid", "cell": 0}
    with pytest.raises(ConfigError, match="'cell'"):
        make(NAVIGATORS, spec)
