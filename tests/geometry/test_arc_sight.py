"""Tangents found ring by ring are those of all pairs: the search ends early, and misses none."""

import math

import numpy as np
import pytest

from benchnav.arena.solid import Kind, Solid
from benchnav.geometry import tangent
from benchnav.geometry.arc_sight import arc_cells, arcs_in_sight
from benchnav.geometry.capsule_grid import capsule_grid
from benchnav.geometry.free_arc import free_arcs
from benchnav.geometry.tangent import bitangents

RADIUS = 0.3


def box(x, y, wide, high, heading):
    corners = np.array([[-wide, -high], [wide, -high], [wide, high], [-wide, high]]) / 2
    c, s = math.cos(heading), math.sin(heading)
    return Solid(Kind.STATIC, (corners @ np.array([[c, s], [-s, c]]) + (x, y),))


def blocks(rng, side):
    """Blocked cells at random, as on maps with a grid: many corners lie in one line."""
    cells = np.argwhere(rng.random((side, side)) < 0.25)
    return [box(i + 0.5, j + 0.5, 1.0, 1.0, 0.0) for i, j in cells.tolist()]


def clutter(rng, side):
    """Boxes in any direction, discs and thin walls, some of which overlap."""
    solids = []
    for _ in range(side * side // 4):
        x, y = rng.uniform(0.0, side, 2)
        kind = rng.integers(3)
        if kind == 0:
            solids.append(box(x, y, *rng.uniform(0.2, 2.0, 2), rng.uniform(0.0, math.pi)))
        elif kind == 1:
            solids.append(Solid(Kind.STATIC, center=(x, y), radius=rng.uniform(0.1, 0.8)))
        else:
            solids.append(
                Solid(Kind.WALL, (np.array([(x, y), (x, y)]) + rng.normal(0, 1, (2, 2)),))
            )
    return solids


def few(rng, side):
    """Little to see: the search goes on to the border of the grid."""
    return clutter(rng, side)[: 4 * side]


def room(rng, side):
    """Clutter within walls."""
    corners = np.array([[-2, -2], [-2, side + 2], [side + 2, side + 2], [side + 2, -2.0]])
    return [Solid(Kind.WALL, (corners,)), *clutter(rng, side)]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("arrangement", [blocks, clutter, few, room])
def test_tangents_are_those_of_all_pairs(arrangement, seed):
    solids = arrangement(np.random.default_rng(seed), 20)
    grid = capsule_grid(np.vstack([solid.capsules for solid in solids]), RADIUS)
    arcs = free_arcs(grid)
    assert len(arcs.radius) > 20
    found = bitangents(grid, arcs, 0)
    every = bitangents(grid, arcs, len(arcs.radius))
    assert found.tobytes() == every.tobytes()
    assert len(found) > 20


def test_most_pairs_are_not_tested():
    """Within walls the search ends early: else it would be correct, but of no use."""
    solids = room(np.random.default_rng(0), 40)
    grid = capsule_grid(np.vstack([solid.capsules for solid in solids]), RADIUS)
    arcs = free_arcs(grid)
    cells = arc_cells(grid, arcs)
    last = range(len(arcs.radius) - 50, len(arcs.radius))
    tried = sum(len(arcs_in_sight(grid, cells, arcs, k)) for k in last)
    assert tried < 0.5 * sum(last)
    assert len(arcs.radius) > 2 * tangent.FEW
