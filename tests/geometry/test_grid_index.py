import numpy as np
import pytest

from benchnav.geometry.grid_index import grid_index, motion_is_free_in
from benchnav.geometry.sweep import motion_is_free


def indexed(p, q, radius, capsules, index):
    return motion_is_free_in(
        *p, *q, radius, capsules, *index.origin, index.side, *index.shape, index.first, index.items
    )


def crowd(rng: np.random.Generator, count: int, length: float) -> np.ndarray:
    a = rng.uniform(-20, 20, (count, 2))
    b = a + rng.normal(size=(count, 2)) * length
    b[::3] = a[::3]
    return np.hstack([a, b, rng.uniform(0, 0.4, (count, 1))])


@pytest.mark.parametrize("length", [0.3, 10.0])
def test_the_index_changes_no_answer(length):
    rng = np.random.default_rng(4)
    seen = set()
    for count in (1, 5, 300):
        capsules = crowd(rng, count, length)
        index = grid_index(capsules, 0.5)
        for _ in range(1500):
            p = rng.uniform(-25, 25, 2)
            q = p + rng.normal(size=2) * rng.choice([0.1, 3.0, 20.0])
            radius = rng.uniform(0, 0.5)
            expected = motion_is_free(*p, *q, radius, capsules)
            assert indexed(p, q, radius, capsules, index) == expected
            seen.add(expected)
    assert seen == {True, False}


def test_motions_along_cell_borders_and_axes_are_answered_alike():
    rng = np.random.default_rng(5)
    capsules = np.round(crowd(rng, 150, 2.0))
    capsules[:, 4] = 0.0
    index = grid_index(capsules, 0.5)
    lines = np.array(index.origin)[:, None] + index.side * np.arange(max(index.shape))
    for _ in range(2000):
        p, q = rng.choice(lines[0], 2), rng.choice(lines[1], 2)
        p, q = np.array([p[0], q[0]]), np.array([p[rng.integers(2)], q[rng.integers(2)]])
        assert indexed(p, q, 0.5, capsules, index) == motion_is_free(*p, *q, 0.5, capsules)


def test_an_index_over_nothing_blocks_nothing():
    index = grid_index(np.zeros((0, 5)), 0.5)
    assert indexed((0.0, 0.0), (3.0, 4.0), 0.5, np.zeros((0, 5)), index)


def test_a_single_point_and_a_long_flat_map_make_an_index():
    for capsules in (np.zeros((1, 5)), np.array([[0.0, 0.0, 1e4, 0.0, 0.0]] * 80)):
        index = grid_index(capsules, 0.0)
        assert indexed((5.0, 1.0), (5.0, 2.0), 0.0, capsules, index)
        assert index.shape[0] * index.shape[1] < 2_000


def test_cells_list_each_capsule_once_and_in_order():
    index = grid_index(crowd(np.random.default_rng(6), 200, 3.0), 0.3)
    for c in range(len(index.first) - 1):
        items = index.items[index.first[c] : index.first[c + 1]]
        assert np.all(np.diff(items) > 0)
