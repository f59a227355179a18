import numpy as np
import pytest

from benchnav.geometry.capsule_grid import SLACK, capsule_grid, is_clear
from benchnav.geometry.sweep import motion_is_free


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
        radius = rng.uniform(0.1, 0.5)
        grid = capsule_grid(capsules, radius)
        for _ in range(1500):
            p = rng.uniform(-25, 25, 2)
            q = p + rng.normal(size=2) * rng.choice([0.1, 3.0, 20.0])
            expected = motion_is_free(*p, *q, radius - SLACK, capsules)
            assert is_clear(grid, *p, *q) == expected
            seen.add(expected)
    assert seen == {True, False}


def test_motions_along_cell_borders_and_axes_are_answered_alike():
    rng = np.random.default_rng(5)
    capsules = np.round(crowd(rng, 150, 2.0))
    capsules[:, 4] = 0.0
    grid = capsule_grid(capsules, 0.5)
    steps = grid.side * np.arange(max(grid.nx, grid.ny))
    for _ in range(2000):
        p = np.array([grid.x + rng.choice(steps), grid.y + rng.choice(steps)])
        q = np.array([grid.x + rng.choice(steps), grid.y + rng.choice(steps)])
        q[rng.integers(2)] = p[0] if rng.random() < 0.5 else p[1]
        expected = motion_is_free(*p, *q, 0.5 - SLACK, capsules)
        assert is_clear(grid, *p, *q) == expected


def test_a_grid_over_nothing_blocks_nothing():
    assert is_clear(capsule_grid(np.zeros((0, 5)), 0.5), 0.0, 0.0, 3.0, 4.0)
