import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchnav.arena.solid import Kind, Solid
from benchnav.geometry.row_index import inside_rows, solid_rows
from benchnav.geometry.sweep import (
    clearance,
    inside_solid,
    motion_is_free,
    segment_capsule_distance,
    segment_distance2,
    solid_index,
)
from tests.reference import sweep as slow

number = st.floats(-10.0, 10.0).map(lambda x: round(x, 3))
point = st.tuples(number, number)


def box(x0: float, y0: float, x1: float, y1: float) -> np.ndarray:
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


def inside(p: tuple[float, float], *solids: Solid) -> bool:
    return inside_solid(*p, np.vstack([s.capsules for s in solids]), *solid_index(solids))


@settings(deadline=None)  # the first call compiles
@given(point, point, point, point)
def test_distance_of_segments_is_that_of_the_slow_twin(a, b, c, d):
    fast = math.sqrt(segment_distance2(*a, *b, *c, *d))
    assert fast == pytest.approx(slow.segment_distance(*map(np.array, (a, b, c, d))), abs=1e-7)


@settings(deadline=None)  # the first call compiles
@given(point, point, point, point)
def test_distance_of_segments_has_no_order_and_no_direction(a, b, c, d):
    d2 = segment_distance2(*a, *b, *c, *d)
    assert d2 == pytest.approx(segment_distance2(*c, *d, *a, *b), abs=1e-12)
    assert d2 == pytest.approx(segment_distance2(*b, *a, *d, *c), abs=1e-12)


@settings(deadline=None)  # the first call compiles
@given(point, point, point, point)
def test_segments_that_share_a_point_have_distance_zero(a, b, c, d):
    assert segment_distance2(*a, *b, *b, *d) == 0.0
    middle = (np.array(a) + b) / 2.0
    assert segment_distance2(*a, *b, *middle, *c) == pytest.approx(0.0, abs=1e-24)


def test_motions_are_free_exactly_where_the_slow_twin_says_so():
    rng = np.random.default_rng(1)
    seen = set()
    for _ in range(600):
        capsules = np.hstack([rng.uniform(-5, 5, (3, 4)), rng.uniform(0, 0.5, (3, 1))])
        capsules[0, 2:4] = capsules[0, :2]  # a disc
        p, q = rng.uniform(-6, 6, (2, 2))
        expected = slow.motion_is_free(p, q, 0.3, capsules)
        assert motion_is_free(*p, *q, 0.3, capsules) == expected
        seen.add(expected)
    assert seen == {True, False}


def test_no_sampled_point_of_a_free_motion_is_in_a_capsule_and_some_point_of_a_blocked_one_is():
    rng = np.random.default_rng(2)
    for _ in range(500):
        capsules = np.hstack([rng.uniform(-5, 5, (4, 4)), rng.uniform(0, 0.5, (4, 1))])
        p, q = rng.uniform(-6, 6, (2, 2))
        along = p + np.linspace(0, 1, 2001)[:, None] * (q - p)
        least = min(clearance(*x, capsules) for x in along)
        if motion_is_free(*p, *q, 0.3, capsules):
            assert least >= 0.3 - 1e-12
        else:
            assert least < 0.3 + np.hypot(*(q - p)) / 2000


def test_touching_is_free_and_less_is_not():
    wall = np.array([[0.0, 0.0, 4.0, 0.0, 0.0]])
    assert motion_is_free(-1.0, 0.5, 5.0, 0.5, 0.5, wall)
    assert not motion_is_free(-1.0, 0.5, 5.0, 0.5, 0.5 + 1e-12, wall)
    assert motion_is_free(-2.0, 0.0, -0.5, 0.0, 0.5, wall)
    assert not motion_is_free(-2.0, 0.0, -0.5 + 1e-9, 0.0, 0.5, wall)


def test_a_point_without_radius_does_not_cross_a_wall():
    wall = np.array([[0.0, 0.0, 4.0, 0.0, 0.0]])
    assert not motion_is_free(1.0, -1.0, 1.0, 1.0, 0.0, wall)
    assert motion_is_free(1.0, 1.0, 1.0, 2.0, 0.0, wall)


def test_distance_of_a_motion_to_a_capsule_is_negative_inside():
    capsule = np.array([0.0, 0.0, 4.0, 0.0, 0.5])
    assert segment_capsule_distance(0.0, 2.0, 4.0, 2.0, capsule) == 1.5
    assert segment_capsule_distance(2.0, -2.0, 2.0, 2.0, capsule) == -0.5


def test_nothing_blocks_where_there_is_nothing():
    nothing = np.zeros((0, 5))
    assert motion_is_free(0.0, 0.0, 1.0, 1.0, 1.0, nothing)
    assert clearance(0.0, 0.0, nothing) == math.inf
    assert not inside_solid(0.0, 0.0, nothing, *solid_index([]))


def test_inside_follows_the_side_on_which_the_solid_lies():
    block = Solid(Kind.STATIC, (box(0, 0, 4, 4),))
    ring = Solid(Kind.STATIC, (box(0, 0, 4, 4), box(1, 1, 3, 3)[::-1]))
    arena = Solid(Kind.WALL, (box(-9, -9, 9, 9)[::-1],))
    with_island = Solid(Kind.WALL, (box(-9, -9, 9, 9)[::-1], box(0, 0, 4, 4)))
    assert inside((2, 2), block)
    assert not inside((5, 2), block)
    assert inside((0.5, 2), ring)
    assert not inside((2, 2), ring)
    assert not inside((5, 5), arena)
    assert inside((10, 5), arena)
    assert inside((2, 2), with_island)
    assert not inside((5, 5), with_island)


def test_overlapping_solids_do_not_cancel():
    a, b = Solid(Kind.STATIC, (box(0, 0, 4, 4),)), Solid(Kind.STATIC, (box(1, 1, 5, 5),))
    assert inside((2, 2), a, b)


@settings(deadline=None)  # the first call compiles
@given(st.lists(point, min_size=2, max_size=6), point)
def test_a_thin_wall_has_no_inside(line, p):
    there_and_back = np.array([*line, *line[-2:0:-1]], float)
    assert not inside(p, Solid(Kind.WALL, (there_and_back,)))


def test_inside_is_what_the_slow_twin_says():
    rng = np.random.default_rng(3)
    for _ in range(200):
        angles = np.sort(rng.uniform(0, 2 * math.pi, 7))
        loop = rng.uniform(1, 5, (7, 1)) * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        if max(np.diff(angles, append=angles[0] + 2 * math.pi)) > 3.0:
            continue
        solid = Solid(Kind.STATIC, (loop[:: rng.choice([1, -1])],))
        for p in rng.uniform(-6, 6, (10, 2)):
            assert inside(tuple(p), solid) == slow.inside_solid(p, solid)


@pytest.mark.parametrize("seed", range(8))
def test_rows_tell_what_is_inside_like_a_walk_over_all_edges(seed):
    rng = np.random.default_rng(seed)
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    solids = [
        Solid(Kind.STATIC, (square * rng.uniform(0.2, 4.0, 2) + rng.uniform(-6, 6, 2),))
        for _ in range(rng.integers(0, 12))
    ]
    solids += [Solid(Kind.STATIC, center=(1.0, 2.0), radius=0.5)] * int(rng.integers(2))
    solids += [Solid(Kind.WALL, (np.array([(-3.0, -1.0), (2.0, 2.0)]),))] * int(rng.integers(2))
    if seed % 2:
        solids.append(Solid(Kind.WALL, ((16.0 * (square - 0.5))[::-1],)))  # endless
    capsules = np.vstack([np.zeros((0, 5)), *(solid.capsules for solid in solids)])
    index, rows = (capsules, *solid_index(solids)), solid_rows(solids)
    corners = capsules[:, :2] if len(capsules) else np.zeros((1, 2))
    places = [*rng.uniform(-10, 10, (300, 2)), *corners, *np.add(corners, (0.01, 0.0))]
    for x, y in places:
        assert inside_rows(rows, x, y) == inside_solid(x, y, *index)
