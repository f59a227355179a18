"""Rotations against libm, touch times against the slow twin, hashed cells against sorting."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchnav.geometry.capsule import capsule_time, disc_time, nearest_on_segment, segments_cross
from benchnav.geometry.hash_grid import bucket, fill, hash_table
from benchnav.geometry.rotation import angle_of, cos_sin, rotated, wrap
from benchnav.world.records import AGENT, SPOT
from tests.reference.step import first_touch, nearest

coordinate = st.floats(-5.0, 5.0)


@given(st.floats(-100.0, 100.0))
def test_cosine_and_sine(angle):
    c, s = cos_sin(angle)
    assert abs(c - math.cos(angle)) < 5e-16
    assert abs(s - math.sin(angle)) < 5e-16
    assert -math.pi <= wrap(angle) < math.pi
    assert math.cos(wrap(angle)) == pytest.approx(math.cos(angle), abs=1e-13)


@given(coordinate, coordinate)
def test_angle_of_a_vector(x, y):
    expected = math.atan2(y + 0.0, x + 0.0)  # no negative zeros: they turn by pi
    assert abs(angle_of(x, y) - expected) < 1e-15


@given(coordinate, coordinate, st.floats(-7.0, 7.0))
def test_turning_there_and_back(x, y, angle):
    there = rotated(np.array([x, y]), angle)
    assert np.hypot(*there) == pytest.approx(math.hypot(x, y), abs=1e-14)
    np.testing.assert_allclose(rotated(there, -angle), [x, y], atol=1e-14)


def test_touch_times_agree_with_the_slow_twin():
    rng = np.random.default_rng(0)
    met = 0
    for _ in range(3000):
        p, v, a, b = rng.uniform(-3.0, 3.0, (4, 2))
        b = a if rng.random() < 0.2 else b
        reach, capsule = rng.uniform(0.1, 1.0), np.array([*a, *b, 0.0])
        slow = first_touch(p, v, capsule, reach)
        fast = capsule_time(*p, *v, reach, math.inf, *a, *b)
        assert fast == pytest.approx(slow, abs=1e-9)
        np.testing.assert_allclose(nearest_on_segment(*p, *a, *b), nearest(p, capsule), atol=1e-12)
        if 0.0 < fast < math.inf:  # it is a touch, and nothing was touched before
            met += 1
            gaps = [
                np.hypot(*(p + v * t - nearest(p + v * t, capsule)))
                for t in np.linspace(0.0, fast, 20)
            ]
            assert gaps[-1] == pytest.approx(reach, abs=1e-7)
            assert min(gaps) >= reach - 1e-7
        way = 0.5 * fast * np.hypot(*v)
        if 0.0 < fast < math.inf:  # what is farther off than the way may be left out, or found
            assert capsule_time(*p, *v, reach, way, *a, *b) in (fast, math.inf)
        if np.array_equal(a, b):
            assert disc_time(*(p - a), *v, reach) == pytest.approx(slow, abs=1e-9)
    assert met > 400


def test_crossing_segments():
    assert segments_cross(0, 0, 2, 2, 0, 2, 2, 0)
    assert not segments_cross(0, 0, 0.9, 0.9, 0, 2, 2, 0)
    assert not segments_cross(0, 0, 1, 0, 0, 1, 1, 1)


def test_hashed_cells_hold_everybody_once_and_in_order():
    rng = np.random.default_rng(1)
    points = np.zeros(300, AGENT)
    points["x"], points["y"] = rng.uniform(-40.0, 40.0, (2, 300))
    points["present"] = rng.random(300) < 0.8
    hashed, spots = hash_table(1, 300)[0], np.zeros(300, SPOT)
    fill(points, hashed, spots, 1.7)
    size = len(hashed) - 1
    assert hashed[-1] == points["present"].sum()
    assert sorted(spots["index"][: hashed[-1]]) == np.flatnonzero(points["present"]).tolist()
    for k in range(size):
        here = spots[hashed[k] : hashed[k + 1]]
        assert (np.diff(here["index"]) > 0).all()
        for spot in here:
            cell = math.floor(spot["x"] / 1.7), math.floor(spot["y"] / 1.7)
            assert (spot["ci"], spot["cj"]) == cell
            assert bucket(*cell, size) == k
