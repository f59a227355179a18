"""What is learned of edges and rays, against sets of points on true outlines."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchnav.geometry.sweep import clearance
from benchnav.navigation.hierarchy.learned_map import (
    DOUBT,
    GUESSED,
    SENSED_EDGE,
    way_is_free,
    with_edge,
    with_guess,
    without_contradicted,
)


class Held:
    """A map with room for 64 capsules."""

    def __init__(self):
        self.capsules = np.zeros((64, 5))
        self.owner = np.zeros(64, np.int64)
        self.n = 0

    @property
    def now(self):
        return self.capsules[: self.n]

    def put(self, capsule, owner):
        self.capsules[self.n], self.owner[self.n] = capsule, owner
        self.n += 1

    def tell(self, start, end, before=None, after=None):
        way = (np.subtract(end, start)) / np.hypot(*np.subtract(end, start))
        turns = [way if turn is None else turn for turn in (before, after)]
        edge = np.concatenate([start, end, *turns])
        self.n, new = with_edge(self.capsules, self.owner, self.n, edge)
        return new


cuts = st.lists(
    st.tuples(st.integers(0, 20), st.integers(0, 20)).filter(lambda c: c[0] != c[1]),
    min_size=1,
    max_size=12,
)


@given(cuts, st.floats(0, 6.28), st.booleans())
@settings(max_examples=60, deadline=None)
def test_pieces_of_a_line_become_their_union(pieces, angle, backwards):
    """Its twin is a set of unit intervals; pieces that meet become one."""
    held, covered = Held(), set()
    along = np.array([np.cos(angle), np.sin(angle)])
    for a, b in pieces:
        a, b = (max(a, b), min(a, b)) if backwards else (a, b)
        before = set(covered)
        covered |= set(range(min(a, b), max(a, b)))
        assert held.tell(a * along, b * along) == (covered != before)
    runs = [k for k in covered if k - 1 not in covered]
    assert held.n == len(runs)
    for k in range(20):
        d = clearance(*((k + 0.5) * along), held.now)
        assert (abs(d) < 1e-9) == (k in covered)


def test_lines_apart_stay_apart():
    held = Held()
    assert held.tell((0, 0), (2, 0))
    assert held.tell((0, 0.001), (2, 0.001))
    assert held.tell((3, 0), (4, 0))
    assert held.tell((0, 0), (0, 1))
    assert held.n == 4


def octagon(x, y, r):
    """(8, 8) start, end, before, after of the octagon about a disc, solid to the left."""
    angle = (np.arange(9) - 0.5) * np.pi / 4
    corner = np.array([x, y]) + r / np.cos(np.pi / 8) * np.stack([np.cos(angle), np.sin(angle)], 1)
    way = np.diff(corner, axis=0)
    way /= np.hypot(*way.T)[:, None]
    return np.hstack([corner[:-1], corner[1:], np.roll(way, 1, axis=0), np.roll(way, -1, axis=0)])


def test_a_disc_is_recovered_from_any_side_of_its_octagon():
    for side in octagon(1.0, -2.0, 0.4):
        held = Held()
        assert held.tell(side[:2], side[2:4], side[4:6], side[6:])
        np.testing.assert_allclose(held.now, [(1.0, -2.0, 1.0, -2.0, 0.4)], atol=1e-12)
        for other in octagon(1.0, -2.0, 0.4):
            assert not held.tell(other[:2], other[2:4], other[4:6], other[6:])


def test_sides_that_were_cut_give_way_to_the_disc():
    held = Held()
    sides = octagon(0.0, 0.0, 1.0)
    assert held.tell(sides[0, :2], 0.5 * (sides[0, :2] + sides[0, 2:4]))
    assert held.tell((3.0, 0.0), (4.0, 0.0))
    assert held.tell(sides[1, :2], sides[1, 2:4], sides[1, 4:6], sides[1, 6:])
    assert sorted(held.now[:, 4].tolist()) == pytest.approx([0.0, 1.0])


def test_long_sides_at_eighth_turns_are_kept_beside_the_disc_in_a_cut_corner():
    held, s = Held(), np.sqrt(0.5)
    assert held.tell((2, 0), (2 + s, s), (1, 0), (0, 1))
    assert held.tell((-2, 0), (2, 0), (0, -1), (s, s))
    assert held.n == 2


@pytest.mark.parametrize("gap", [-0.3, -DOUBT - 0.01, -DOUBT + 0.01, 0.0, 0.2])
def test_a_free_disc_clears_what_it_must_have_met(gap):
    """A disc of 0.5 m passes along y = 0; an edge is ``gap`` from its rim."""
    held = Held()
    held.tell((1.0, 0.5 + gap), (2.0, 0.5 + gap))
    held.tell((9.0, 0.0), (9.0, 1.0))
    held.n = without_contradicted(held.capsules, held.owner, held.n, 0.0, 0.0, 8.0, 0.0, 0.5)
    assert held.n == (1 if gap < -DOUBT else 2)
    assert held.now[-1].tolist() == [9.0, 0.0, 9.0, 1.0, 0.0]


def test_a_solid_of_the_granted_map_goes_as_a_whole():
    held = Held()
    for k, owner in enumerate((0, 7, 7, SENSED_EDGE, 7, 1)):
        held.put((2.0 * k, 0.0, 2.0 * k, 0.2, 0.0), owner)
    held.n = without_contradicted(held.capsules, held.owner, held.n, 2.0, -1.0, 2.0, 1.0, 0.3)
    assert held.owner[: held.n].tolist() == [0, SENSED_EDGE, 1]
    assert held.now[:, 0].tolist() == [0.0, 6.0, 10.0]


def test_a_stopped_disc_is_explained_or_guessed_at():
    held = Held()
    held.tell((2.0, -1.0), (2.0, 1.0))
    seen = (1.7, 0.0, 1.0, 0.0, 0.3)  # stopped by that edge
    assert with_guess(held.capsules, held.owner, held.n, *seen) == 1
    held.n = with_guess(held.capsules, held.owner, held.n, 0.0, 3.0, 0.0, 1.0, 0.3)
    assert held.owner[: held.n].tolist() == [SENSED_EDGE, GUESSED]
    assert clearance(0.0, 3.0, held.now) == pytest.approx(0.3)
    assert with_guess(held.capsules, held.owner, held.n, 0.0, 3.0, 0.6, 0.8, 0.3) == 2
    aside = (0.0, 3.0, 1.0, 0.0, 0.3)  # what is straight ahead explains no stop on the way aside
    assert with_guess(held.capsules, held.owner, held.n, *aside) == 3


def test_a_way_is_free_where_each_of_its_motions_is():
    rng = np.random.default_rng(3)
    ends = rng.uniform(-4, 4, (6, 2))
    capsules = np.hstack([ends, ends + rng.uniform(-1, 1, (6, 2)), rng.uniform(0, 0.5, (6, 1))])
    found = []
    for _ in range(200):
        way = np.cumsum(rng.uniform(-2, 2, (3, 2)), axis=0)
        share = np.linspace(0, 1, 400)[:, None]
        points = np.vstack([a + share * (b - a) for a, b in pairwise(way)])
        least = min(clearance(*point, capsules) for point in points)
        if abs(least - 0.3) > 0.02:
            found.append(least > 0.3)
            assert way_is_free(way, 0.3, capsules) == found[-1]
    assert 5 < sum(found) < len(found)
