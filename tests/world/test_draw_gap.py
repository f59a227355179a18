"""The placement kernel against shapely."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from benchnav.arena.solid import Kind, Solid
from benchnav.generation.clearance import POINT, barrier, clear, first_clear, joined
from benchnav.generation.placement import next_apart
from benchnav.generation.solids import bounds_wall
from benchnav.geometry.rotation import rotated
from tests.reference import clearance as slow

_PLACE = st.tuples(st.floats(-4, 4), st.floats(-4, 4)).map(np.array)


@st.composite
def solids(draw):
    """Discs, turned boxes, boxes with a hole, two boxes as one, thin walls."""
    at = draw(_PLACE)
    size = draw(st.floats(0.2, 2.0))
    kind = draw(st.sampled_from(["disc", "box", "frame", "pair", "line"]))
    turn = draw(st.floats(0, 6.2))
    square = rotated(size * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1.0]]), turn)
    loops = {
        "disc": (),
        "box": (square,),
        "frame": (square, 0.8 * square[::-1]),
        "pair": (square, 0.5 * square + 2.5 * size),
        "line": (rotated(size * np.array([[-1, 0], [0, 0.5], [1, 0], [0, 0.5]]), turn),),
    }[kind]
    radius = size if kind == "disc" else 0.0
    return Solid(Kind.WALL, loops, (0.0, 0.0), radius).moved(at)


@st.composite
def shapes(draw):
    """Points, tracks, boxes and pairs of boxes about the origin."""
    kind = draw(st.sampled_from(["point", "track", "box", "pair"]))
    if kind == "point":
        return np.zeros((1, 5))
    if kind == "track":
        end = draw(_PLACE)
        return np.array([[0.0, 0.0, *end, draw(st.floats(0.1, 1.0))]])
    size = draw(st.floats(0.1, 5.0))
    square = size * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1.0]])
    loops = (
        (square,) if kind == "box" else (square, 0.5 * square + draw(st.floats(1.6, 3.0)) * size)
    )
    return Solid(Kind.STATIC, loops).capsules


@settings(max_examples=300, deadline=None)
@given(st.lists(solids(), max_size=4), shapes(), _PLACE, st.floats(0, 2), st.booleans())
def test_agrees_with_shapely(walls, shape, place, gap, walled):
    if walled:
        walls = [bounds_wall((-5, -5, 5, 5)), *walls]
    true = slow.gap(shape + np.array([*place, *place, 0.0]), walls)
    assume(abs(true - gap) > 1e-3)  # shapely's discs are polygons
    assert clear(shape, place[None], barrier(walls), gap)[0] == (true > gap)


@settings(max_examples=100, deadline=None)
@given(st.lists(solids(), max_size=3), st.lists(solids(), max_size=3), _PLACE, st.floats(0, 1))
def test_clear_of_joined_is_clear_of_both(some, more, place, gap):
    both = joined(barrier(some), barrier(more))
    apart = [clear(POINT, place[None], barrier(part), gap)[0] for part in (some, more)]
    assert clear(POINT, place[None], both, gap)[0] == all(apart)


def test_only_a_whole_shape_encloses_a_solid():
    loop = 2.0 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1.0]])
    square = Solid(Kind.STATIC, (loop,)).capsules
    inside = barrier([Solid(Kind.STATIC, (), (0.0, 0.0), 0.5)])
    here = np.zeros((1, 2))
    assert not clear(square, here, inside, 0.1)[0]
    assert clear(square, here, inside, 0.1, whole=False)[0]
    assert not clear(square, here, inside, 1.6, whole=False)[0]


def test_every_shape_is_judged_for_itself():
    points = np.array([[0.0, 0.0], [3.0, 0.0], [0.6, 0.0]])
    wall = barrier([Solid(Kind.STATIC, (), (0.0, 0.0), 0.5)])
    assert clear(POINT, points, wall, 0.0).tolist() == [False, True, True]
    assert clear(POINT, points, wall, 0.2).tolist() == [False, True, False]
    assert clear(POINT, points, barrier([]), 9.0).all()


@pytest.mark.parametrize("walled", [False, True])
@pytest.mark.parametrize("kind", ["point", "box", "tracks"])
def test_many_points_among_many_solids_are_judged_like_each_alone(walled, kind):
    rng = np.random.default_rng(7)
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1.0]])
    walls = [bounds_wall((-20, -20, 20, 20))] if walled else []
    for _ in range(40):
        size, turn, at = rng.uniform(0.2, 2.0), rng.uniform(0, 6.2), rng.uniform(-20, 20, 2)
        outer = rotated(size * square, turn)
        walls.append(Solid(Kind.WALL, (outer, 0.8 * outer[::-1])).moved(at))
        walls.append(Solid(Kind.STATIC, (), (0.0, 0.0), 0.3 * size).moved(at[::-1]))
    shape = {
        "point": POINT,
        "box": Solid(Kind.STATIC, (0.7 * square,)).capsules,
        "tracks": np.array([[0.0, 0.0, 1.0, 0.5, 0.1], [2.0, 0.0, 2.0, 3.0, 0.2]]),
    }[kind]
    points = rng.uniform(-22, 22, (500, 2))
    for gap in (0.0, 0.4):
        together = clear(shape, points, barrier(walls), gap, whole=kind != "tracks")
        alone = [
            clear(shape, point[None], barrier(walls), gap, whole=kind != "tracks")[0]
            for point in points
        ]
        assert together.tolist() == alone
        assert 20 < together.sum() < 480


@settings(max_examples=50, deadline=None)
@given(st.lists(solids(), max_size=3), shapes(), st.lists(_PLACE, max_size=6), st.floats(0, 1))
def test_the_first_clear_point_is_the_first_of_the_clear_ones(walls, shape, places, gap):
    points = np.array(places).reshape(-1, 2)
    clear_ones = np.flatnonzero(clear(shape, points, barrier(walls), gap))
    expected = clear_ones[0] if len(clear_ones) else -1
    assert first_clear(shape, points, barrier(walls), gap) == expected


def test_the_next_point_apart_keeps_all_distances():
    rng = np.random.default_rng(1)
    points, others = rng.uniform(-3, 3, (40, 2)), rng.uniform(-3, 3, (5, 2))
    radius, origin = rng.uniform(0.1, 0.8, 5), np.array([1.0, 0.0])
    apart = np.hypot(*(points - origin).T) >= 1.5
    for other, r in zip(others, radius, strict=True):
        apart &= np.hypot(*(points - other).T) > r + 0.3
    found, k = [], -1
    while (k := next_apart(k + 1, points, origin, 1.5, others, radius, 0.3)) >= 0:
        found.append(k)
    assert found == np.flatnonzero(apart).tolist()
    assert 5 < len(found) < 35
