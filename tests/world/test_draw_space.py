"""Free space: both forms agree, and neither calls joined what is not."""

import numpy as np
import pytest

from benchnav.arena.solid import Kind, Solid
from benchnav.generation import free_space
from benchnav.generation.build import build
from benchnav.generation.clearance import barrier
from benchnav.generation.free_space import JoinedSpace, PartedSpace
from benchnav.generation.solids import bounds_wall
from benchnav.scenario import catalogue
from tests.reference import clearance as slow

BOUNDS = (-10.0, -10.0, 10.0, 10.0)


def ring(center, inner, outer):
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1.0]])
    return Solid(Kind.WALL, (outer * square + center, (inner * square + center)[::-1]))


def test_an_enclosed_yard_is_apart():
    walls = [bounds_wall(BOUNDS), ring((0, 0), 2, 3)]
    space = PartedSpace(barrier(walls), BOUNDS, True, 0.5)
    yard, wall, outside, edge = space.labels(
        np.array([[0, 0], [2.5, 0], [-8, 8], [9.6, 0]], dtype=float)
    )
    assert yard >= 0
    assert outside >= 0
    assert yard != outside
    assert wall == edge == -1


def test_nothing_is_free_where_the_disc_does_not_fit():
    walls = [bounds_wall((0, 0, 1, 1))]
    space = PartedSpace(barrier(walls), (0, 0, 1, 1), True, 0.6)
    assert space.labels(np.array([[0.5, 0.5]]))[0] == -1


def test_unwalled_arenas_may_be_left():
    bar = Solid(Kind.WALL, (np.array([[-1, -10], [1, -10], [1, 10], [-1, 10.0]]),))
    space = PartedSpace(barrier([bar]), BOUNDS, False, 0.5)
    left, right = space.labels(np.array([[-5, 0], [5, 0]], dtype=float))
    assert left == right >= 0


@pytest.mark.parametrize("seed", range(5))
def test_both_forms_agree_among_convex_solids_that_are_far_apart(seed):
    world = build(catalogue.find("leaders/static"), "validation", seed)
    wall = barrier(world.solids)
    points = np.random.default_rng(seed).uniform(-10, 10, (400, 2))
    one = JoinedSpace(wall, 0.5).labels(points)
    other = PartedSpace(wall, world.bounds, True, 0.5).labels(points)
    true = slow.clearances(points, world.solids)
    sure = np.abs(true - 0.5) > 0.005
    np.testing.assert_array_equal(one[sure], other[sure])
    np.testing.assert_array_equal(one[sure] >= 0, true[sure] > 0.5)


def _blocked(rng):
    """Squares, some in rings around others, some beyond the border, some that touch."""
    import shapely

    solids = []
    for x, y in 10.0 * rng.integers(0, 8, (30, 2)) + rng.choice([0.0, 1.0], (30, 2)):
        square = shapely.box(x, y, x + 8.0, y + 8.0)
        if rng.random() < 0.5:
            square = square.difference(shapely.box(x + 1.0, y + 1.0, x + 7.0, y + 7.0))
            square = square.union(shapely.box(x + 3.0, y + 3.0, x + 4.0, y + 4.0))
        if rng.random() < 0.2:
            square = square.union(shapely.box(x + 8.0, y + 8.0, x + 9.0, y + 9.0))  # at a corner
        solids.append(square)
    return shapely.disjoint_subset_union_all(solids)


@pytest.mark.parametrize("seed", range(20))
def test_faces_are_those_of_the_difference(seed):
    import shapely

    arena, blocked = shapely.box(3.0, 3.0, 75.0, 75.0), _blocked(np.random.default_rng(seed))
    expected = shapely.get_parts(arena.difference(blocked))
    faces = [face for face in free_space._faces(arena, blocked) if face.area > 0.0]
    assert all(shapely.is_valid(face) for face in faces)
    assert len(faces) == len(expected)
    for face in faces:
        assert any(face.equals(other) for other in expected)


def test_nothing_blocked_leaves_the_arena():
    import shapely

    arena = shapely.box(0.0, 0.0, 1.0, 2.0)
    (face,) = free_space._faces(arena, shapely.Polygon())
    assert face.equals(arena)
