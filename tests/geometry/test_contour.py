import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from benchnav.geometry.contour import outlines
from tests.reference import contour as slow

grids = arrays(bool, st.tuples(st.integers(1, 9), st.integers(1, 9)))


def picture(*rows):
    """Rows from the top, # blocked → row 0 at the bottom."""
    return np.array([[cell == "#" for cell in row] for row in rows[::-1]])


def area(loop):
    x, y = loop.T
    return 0.5 * float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())


def unit_edges(loop):
    for a, b in zip(loop.astype(int), np.roll(loop.astype(int), -1, axis=0), strict=True):
        step = np.sign(b - a)
        for k in range(int(np.abs(b - a).sum())):
            yield tuple((a + k * step).tolist()), tuple((a + (k + 1) * step).tolist())


def test_an_empty_room_has_its_four_corners_clockwise():
    (outline,) = outlines(np.zeros((3, 5), bool))
    (loop,) = outline.loops
    assert {tuple(p) for p in loop} == {(0, 0), (0, 3), (5, 3), (5, 0)}
    assert area(loop) == -15.0


def test_an_island_runs_counter_clockwise_and_its_pond_clockwise():
    room, island = outlines(
        picture(".......", ".#####.", ".#...#.", ".#.#.#.", ".#...#.", ".#####.", ".......")
    )[:2]
    assert [area(loop) for loop in room.loops] == [-49.0]
    assert sorted(area(loop) for loop in island.loops) == [-9.0, 25.0]


def test_nothing_free_has_no_outline():
    assert outlines(np.ones((2, 3), bool)) == ()


def test_cells_that_touch_at_a_corner_are_one_and_leave_no_gap():
    room, pair = outlines(picture("....", ".#..", "..#.", "...."))
    assert len(room.loops) == 1
    (loop,) = pair.loops
    assert area(loop) == 2.0
    # it runs through the common corner twice, each time around one free cell
    assert sum(tuple(p) == (2.0, 2.0) for p in loop) == 2


def test_a_diagonal_wall_parts_the_room():
    (outline,) = outlines(picture("..#", ".#.", "#.."))
    assert sorted(area(loop) for loop in outline.loops) == [-3.0, -3.0]


@settings(deadline=None)  # the first call imports
@given(grids)
def test_every_edge_of_a_free_cell_is_traced_once(blocked):
    traced = [
        {edge for loop in outline.loops for edge in unit_edges(loop)}
        for outline in outlines(blocked)
    ]
    parts = [slow.unit_edges(part, blocked) for part in slow.components(blocked)]
    assert sorted(map(sorted, traced)) == sorted(sorted(p) for p in parts if p)
    count = sum(len(list(unit_edges(loop))) for o in outlines(blocked) for loop in o.loops)
    assert count == sum(map(len, parts))


@settings(deadline=None)  # the first call imports
@given(grids)
def test_vertices_are_corners_and_areas_add_up(blocked):
    loops = [loop for outline in outlines(blocked) for loop in outline.loops]
    for loop in loops:
        before, after = loop - np.roll(loop, 1, axis=0), np.roll(loop, -1, axis=0) - loop
        assert np.all((before * after).sum(axis=1) == 0)
        assert np.all((before != 0).sum(axis=1) == 1)
    assert sum(map(area, loops)) == pytest.approx(-float((~blocked).sum()))


@settings(deadline=None)  # the first call imports
@given(grids)
def test_a_clockwise_loop_of_free_cells_never_joins_cells_that_touch_at_a_corner(blocked):
    """Each clockwise loop bounds 4-connected free cells: it visits no lattice point twice
    from outside, so that its area is that of one such set."""
    from scipy import ndimage

    label, count = ndimage.label(~blocked)
    holes = sum(area(loop) < 0 for outline in outlines(blocked) for loop in outline.loops)
    assert holes == count
    assert label.max() == count
