"""Sums of segments against convex hulls and sampled motions."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchnav.geometry.segment_sum import distance_to_sum, time_to_sum
from tests.reference.footprint import hull_distance, sum_hull

LENGTH = st.sampled_from([0.0, 1e-3, 0.1, 0.35, 1.0])
ANGLE = st.one_of(
    st.sampled_from([0.0, math.pi / 2, math.pi, -math.pi / 2]), st.floats(-math.pi, math.pi)
)
PLACE = st.floats(-3.0, 3.0)


@st.composite
def sums(draw) -> tuple[tuple, tuple]:
    """Half segments of two rectangles, as in a contact of two bodies."""
    gx, gy = [], []
    for _ in range(2):
        angle = draw(ANGLE)
        for turn in (0.0, math.pi / 2):
            size = draw(LENGTH)
            gx.append(size * math.cos(angle + turn))
            gy.append(size * math.sin(angle + turn))
    return tuple(gx), tuple(gy)


@settings(max_examples=150)
@given(sums(), PLACE, PLACE)
def test_the_distance_is_that_of_the_convex_hull(shape, x, y):
    hull = sum_hull(*shape)
    nx, ny, found = distance_to_sum(x, y, *shape)
    assert found == pytest.approx(hull_distance(x, y, hull), abs=1e-9)
    if found > 1e-6:  # a step along the direction is a step away
        scale = 1e-4 / math.hypot(nx, ny)
        away = distance_to_sum(x + scale * nx, y + scale * ny, *shape)[2]
        assert away == pytest.approx(found + 1e-4, abs=1e-9)


@settings(max_examples=150)
@given(sums(), PLACE, PLACE, ANGLE, st.sampled_from([0.02, 0.3]))
def test_the_contact_time_is_the_first_of_a_sampled_motion(shape, x, y, angle, reach):
    wx, wy = math.cos(angle), math.sin(angle)
    hull = sum_hull(*shape)
    start = hull_distance(x, y, hull) - reach
    found = time_to_sum(x, y, wx, wy, reach, 8.0, *shape)
    if start < 1e-6:
        assert found in (0.0, math.inf)
        return
    times = np.linspace(0.0, 8.0, 801)
    gaps = np.array([hull_distance(x + wx * t, y + wy * t, hull) - reach for t in times])
    if found <= 8.0:
        assert abs(hull_distance(x + wx * found, y + wy * found, hull) - reach) < 1e-7
        assert (gaps[times < found - 1e-9] > -1e-9).all()
    else:
        assert (gaps > -1e-9).all()


def test_a_body_that_slides_along_a_face_or_leaves_it_is_not_stopped():
    square = (0.5, 0.0, 0.0, 0.0), (0.0, 0.5, 0.0, 0.0)
    assert time_to_sum(0.0, 0.6, 1.0, 0.0, 0.1, 9.0, *square) == math.inf
    assert time_to_sum(0.0, 0.59, 0.0, 1.0, 0.1, 9.0, *square) == math.inf
    assert time_to_sum(0.0, 0.59, 0.1, -1.0, 0.1, 9.0, *square) == 0.0
    assert time_to_sum(0.0, 0.9, 0.0, -1.0, 0.1, 9.0, *square) == pytest.approx(0.3)
