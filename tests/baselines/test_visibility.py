import math

import numpy as np
import pytest

from tests.baselines.planning import (
    RADIUS,
    SCENARIOS,
    arena,
    assert_valid,
    block,
    disc,
    drawn,
    excess,
    furnished,
    plan,
    space,
)

EXACT = {"type": "visibility", "clearance": 0.0, "bend": 0.003}


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_paths_in_drawn_worlds_are_the_shortest(scenario):
    for query in drawn(scenario):
        assert excess(plan(EXACT, *query), *query[:4]) == pytest.approx(0.0, abs=1e-6)


def test_paths_among_overlapping_solids_are_the_shortest():
    for seed in range(20):
        map = furnished(seed)
        found = plan(EXACT, map, tolerance=0.0)
        assert_valid(found, map, tolerance=0.0)
        assert excess(found, map) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("bend", [0.01, 0.1, 1.0])
def test_around_a_disc_are_two_tangents_and_a_polyline_that_turns_by_the_bend(bend):
    map = arena(disc(10.0, 10.0, 2.0))
    found = plan({**EXACT, "bend": bend}, map, (4.0, 10.0), (16.0, 10.0))
    assert_valid(found, map, (4.0, 10.0), (16.0, 10.0))
    arc, tangents = 2.3 * 2 * math.asin(2.3 / 6), 2 * math.sqrt(36 - 2.3**2)
    longest = tangents + arc * (1 + bend**2 / 12 * 1.12)
    assert tangents + arc - 1e-5 <= found.length <= longest
    heading = np.arctan2(*np.diff(found.path, axis=0).T[::-1])
    assert np.abs(np.diff(heading)).max() <= bend + 1e-6


def test_the_clearance_is_that_of_a_larger_disc():
    map = furnished(5)
    found = plan({**EXACT, "clearance": 0.1}, map)
    assert excess(found, map, radius=RADIUS + 0.1) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("room", [0.0, 1e-6, 1e-3])
def test_a_slot_around_a_corner_is_followed_however_tight(room):
    """The disc rolls around a corner that another one faces, with next to no room between."""
    gap = (2.0 * RADIUS + room) * math.sqrt(0.5)
    map = arena(block(0.0, 0.0, 5.0, 5.0), block(5.0 + gap, 5.0 + gap, 10.0, 10.0))
    start, goal = (2.0, 5.6), (5.6, 2.0)
    found = plan({"type": "visibility", "clearance": 0.0}, map, start, goal)
    assert_valid(found, map, start, goal)
    assert found.length < 1.001 * space(map, RADIUS).length(start, goal)


def test_a_free_goal_that_cannot_be_reached_is_come_near_to():
    """A wall passes through the goal disc; the path ends at the disc's rim on this side."""
    map = arena(block(0.0, 10.0, 20.0, 0.1))
    start, goal = (3.0, 4.0), (17.0, 10.1 + RADIUS)
    found = plan(EXACT, map, start, goal, tolerance=0.8)
    assert_valid(found, map, start, goal, tolerance=0.8)
    assert math.dist(found.path[-1], goal) == pytest.approx(0.99 * 0.8, abs=1e-6)
    assert found.length == pytest.approx(space(map, RADIUS).length(start, goal, 0.99 * 0.8))
