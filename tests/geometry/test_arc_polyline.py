import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchnav.geometry.arc_polyline import around_arc
from benchnav.geometry.capsule_grid import SLACK, capsule_grid, is_clear

CORNER = (0.0, 0.0, 0.0, 0.0, 0.0)


def polar(radius, angle):
    return np.array([radius * math.cos(angle), radius * math.sin(angle)])


def slow(grid, radius, begin, end, bend):
    """Halve every piece that touches."""

    def corners(low, high):
        corner = polar(radius / math.cos((high - low) / 2), (low + high) / 2)
        sides = (polar(radius, low), corner), (corner, polar(radius, high))
        far = np.hypot(*corner) - radius
        if far <= SLACK or all(is_clear(grid, *p, *q) for p, q in sides):
            return [corner]
        middle = (low + high) / 2
        return corners(low, middle) + corners(middle, high)

    count = max(1, math.ceil(abs(end - begin) / bend))
    cuts = [begin + (end - begin) * k / count for k in range(count + 1)]
    return [corner for pair in itertools.pairwise(cuts) for corner in corners(*pair)]


@given(
    st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(0.05, 1.0), st.floats(1e-9, 0.01),
    st.floats(-3.0, 3.0),
)  # fmt: skip
def test_it_is_the_slow_twin_and_as_clear_as_the_arc(begin, end, bend, room, at):
    """A disc of 0.5 m rolls around a point, past another that leaves it ``room``."""
    near = polar(1.0 + room, at)
    grid = capsule_grid(np.array([CORNER, (*near, *near, 0.0)]), 0.5)
    found = around_arc(grid, 0.0, 0.0, 0.5, begin, end, bend)
    twin = slow(grid, 0.5, begin, end, bend)
    assert found == pytest.approx(np.array(twin), abs=1e-12)
    line = [polar(0.5, begin), *found, polar(0.5, end)]
    tight = capsule_grid(np.array([CORNER, (*near, *near, 0.0)]), 0.5 - SLACK)
    assert all(is_clear(tight, *p, *q) for p, q in itertools.pairwise(line))


@given(st.floats(0.001, 1.0), st.floats(0.01, 3.0))
def test_its_length_is_the_arc_and_a_twelfth_of_the_bend_squared(bend, turn):
    grid = capsule_grid(np.array([CORNER]), 0.5)
    line = [polar(0.5, 0.3), *around_arc(grid, 0.0, 0.0, 0.5, 0.3, 0.3 + turn, bend)]
    line.append(polar(0.5, 0.3 + turn))
    length = np.hypot(*np.diff(line, axis=0).T).sum()
    assert 0.5 * turn <= length + 1e-12
    assert length <= 0.5 * turn * (1.0 + bend * bend / 12 * 1.12) + 1e-12
