"""Walls without area: rounding never makes one the outside of an arena."""

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from benchnav.arena.solid import Kind, Solid, is_outside, signed_area
from benchnav.generation.build import build
from benchnav.generation.clearance import barrier
from benchnav.scenario.load import scenario_from_text

NUMBER = st.floats(-500.0, 500.0)
POINTS = st.lists(st.tuples(NUMBER, NUMBER), min_size=2, max_size=12, unique=True)


def forth_and_back(points):
    points = np.array(points, float)
    return np.vstack([points, points[-2:0:-1]])


@given(POINTS, st.floats(-math.pi, math.pi), NUMBER)
@example([(0.0, 0.0), (1.0, 0.7), (2.1, 0.3)], 0.3, 100.0)
def test_a_polyline_is_not_outside(points, turn, shift):
    way = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    loop = forth_and_back(points) @ way.T + shift
    wall = Solid(Kind.WALL, (loop,))
    assert signed_area(loop) == 0.0
    assert not is_outside(wall)
    assert not barrier([wall]).hollow.any()


@given(NUMBER, NUMBER, st.floats(0.01, 1000.0), st.floats(0.01, 1000.0))
def test_bounds_are_outside_and_boxes_are_not(x, y, width, height):
    ring = np.array([[x, y], [x, y + height], [x + width, y + height], [x + width, y]])
    outer, box = Solid(Kind.WALL, (ring,)), Solid(Kind.WALL, (ring[::-1],))
    assert is_outside(outer)
    assert not is_outside(box)
    assert barrier([outer, box]).hollow.tolist() == [True, False]
    assert signed_area(ring) == pytest.approx(-width * height, rel=1e-6)
    assert not is_outside(Solid(Kind.DYNAMIC, (), (x, y), width))


def test_agents_start_beside_a_thin_wall_in_any_direction():
    """Three points whose loop has a tiny negative area took away all space."""
    walls = "\n".join(
        f"  - shape: {{type: polyline, points: [[0, 0], [0.3, 0.1], [0.7, {0.1 + k / 70}]]}}\n"
        f"    at: [{k / 3 - 3:.3f}, {k / 7 - 1:.3f}]\n    heading: {0.37 * k:.2f}"
        for k in range(12)
    )
    text = f"""\
name: tests/thin
bounds: [-6, -6, 6, 6]
walls:
{walls}
teams:
  - name: crowd
    count: 8
    radius: 0.2
    max_speed: 1
    start: {{type: region, region: {{type: anywhere}}}}
    goal: {{type: region, region: {{type: anywhere}}}}
"""
    world = build(scenario_from_text(text, "thin.yaml"), "test", 0)
    assert len(world.agents) == 8
    assert [is_outside(solid) for solid in world.solids].count(True) == 1
