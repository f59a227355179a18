"""Path keeping and catching up: closed cases, and slow twins of the kernels."""

import math

import numpy as np
import pytest
import shapely
from scipy.sparse.csgraph import connected_components

from benchnav.arena.agents import Role
from benchnav.metrics import following
from benchnav.metrics.measure import load_metric, measure
from benchnav.testing.episodes import Setting, Walk, record, straight, wave


def _follower(path, goal=(90.0, 0.0), **options):
    return Walk(path, goal, radius=0.2, role=Role.FOLLOWER, **options)


def _leader(path, **options):
    return Walk(path, (90.0, 0.0), radius=0.2, **options)


def test_a_follower_beside_a_straight_way():
    """0.7 m beside it; for the first 3 of 10 s before its start, which does not count."""
    walks = [
        _leader(straight((0.0, 0.0), (1.0, 0.0))),
        _follower(straight((-3.0, 0.7), (1.0, 0.0))),
        _follower(lambda t: np.stack([2.0 + 0.0 * t, 0.1 * t], axis=1)),  # leaves it sideways
        _follower(straight((-30.0, 0.7), (1.0, 0.0))),  # never beside it
    ]
    found = following.path_keeping(record(walks, Setting(horizon=10.0)))
    assert math.isnan(found[0])
    assert found[1] == pytest.approx(0.7)
    assert found[2] == pytest.approx(0.1 * np.arange(0.0, 10.0, 0.5).mean())
    assert math.isnan(found[3])


def test_the_way_is_that_of_the_own_team_and_of_a_leader_that_moved():
    walks = [
        _leader(straight((0.0, 0.0), (1.0, 0.0)), team=0),
        _leader(straight((0.0, 5.0), (1.0, 0.0)), team=1),
        _leader(straight((3.0, 2.1), (0.0, 0.0)), team=1),  # stands: its place is no way
        _follower(straight((1.0, 2.0), (0.5, 0.0)), team=0),
        _follower(straight((1.0, 2.0), (0.5, 0.0)), team=1),
        _follower(straight((1.0, 2.0), (0.5, 0.0)), team=2),
    ]
    found = following.path_keeping(record(walks, Setting(horizon=10.0)))
    assert found[3:5] == pytest.approx([2.0, 3.0])
    assert np.isnan(found[[0, 1, 2, 5]]).all()


def test_the_nearest_of_several_ways_counts():
    walks = [
        _leader(straight((0.0, 0.0), (1.0, 0.0))),
        _leader(straight((0.0, 3.0), (1.0, 0.0))),
        _follower(straight((1.0, 2.0), (0.5, 0.0))),
    ]
    assert following.path_keeping(record(walks, Setting(horizon=10.0)))[2] == pytest.approx(1.0)


def test_a_leader_that_ends_leaves_the_way_so_far():
    """After 4 s and 4 m: the follower is beside it until it is 4 m on, too."""
    walks = [
        _leader(straight((0.0, 0.0), (1.0, 0.0)), ends=4.0),
        _follower(lambda t: np.stack([t, np.minimum(0.1 * t, 0.4)], axis=1)),
    ]
    found = following.path_keeping(record(walks, Setting(horizon=10.0)))[1]
    assert found == pytest.approx(0.1 * np.arange(0.5, 4.0, 0.5).mean())


def test_lateral_distance_is_that_to_the_line():
    """Against shapely, at random places beside a curved way; ends do not count."""
    rng = np.random.default_rng(2)
    path = wave((0.0, 0.0), 1.0, 1.5, 5.0)(np.linspace(0.0, 12.0, 60))
    line, first = shapely.LineString(path), np.array([0, 60])
    beside = 0
    for x, y in rng.uniform((-3.0, -4.0), (15.0, 4.0), (300, 2)):
        point = shapely.Point(x, y)
        along = line.project(point)
        found = following._lateral(x, y, path, first)
        if 0.0 < along < line.length:
            beside += 1
            assert found == pytest.approx(line.distance(point), abs=1e-9)
        else:
            assert found == -1.0
    assert 100 < beside < 290


def _held_up(start, begin, end, speed=1.0):
    """At ``speed`` along +x, but standing from ``begin`` to ``end`` and then at thrice of it."""

    def path(t):
        x = np.minimum(t, begin) + 3.0 * np.clip(t - end, 0.0, 0.5 * (end - begin))
        x += np.maximum(t - end - 0.5 * (end - begin), 0.0)
        return np.array(start) + np.stack([speed * x, 0.0 * t], axis=1)

    return path


def test_a_follower_that_falls_behind_and_comes_back():
    """Held up from 2 to 6 s, back beside the others at 8 s.

    The link of 3 · 0.4 m holds while it is at most √(1.2² − 0.5²) = 1.09 m behind: until
    3.09 s, and again from 8 − 1.09/2 = 7.45 s on. At 2 Hz: from 3.5 to 7 s, 8 instants.
    """
    rows = [straight((0.0, y), (1.0, 0.0)) for y in (0.0, 0.5, 1.0)]
    walks = [
        _leader(straight((5.0, 0.0), (1.0, 0.0))),
        *(_follower(path, (90.0, y)) for path, y in zip(rows, (0.0, 0.5, 1.0), strict=True)),
        _follower(_held_up((0.0, 1.5), 2.0, 6.0), (90.0, 1.5)),
    ]
    episode = record(walks, Setting(horizon=12.0))
    found = following.catch_up_time(episode)
    assert found[4] == pytest.approx(4.0)
    assert np.isnan(found[:4]).all()
    rows = {row["role"]: row for row in measure(episode, [load_metric("catch_up_time")])}
    assert (rows["follower"]["value"], rows["follower"]["defined"]) == (4.0, 1)
    assert rows["leader"]["defined"] == 0


def test_who_is_ahead_or_one_of_two_halves_is_not_behind():
    pair = [straight((0.0, 0.0), (1.0, 0.0)), straight((0.0, 0.5), (1.0, 0.0))]
    ahead = record([_follower(p) for p in (*pair, straight((5.0, 0.0), (1.0, 0.0)))])
    assert np.isnan(following.catch_up_time(ahead)).all()
    halves = [*pair, straight((-5.0, 0.0), (1.0, 0.0)), straight((-5.0, 0.5), (1.0, 0.0))]
    assert np.isnan(following.catch_up_time(record([_follower(p) for p in halves]))).all()


def test_who_never_comes_back_counts_until_it_is_over():
    walks = [
        _follower(straight((0.0, 0.0), (1.0, 0.0))),
        _follower(straight((0.0, 0.5), (1.0, 0.0))),
        _follower(straight((-5.0, 0.0), (0.5, 0.0)), ends=6.0),
    ]
    found = following.catch_up_time(record(walks, Setting(horizon=10.0)))
    assert found[2] == pytest.approx(6.0)
    alone = record(walks[2:], Setting(horizon=10.0))
    assert np.isnan(following.catch_up_time(alone)).all()


def test_mean_runs():
    state = np.array([[0, 1, 1, 0, 1, 0], [1, 1, 1, 1, 1, 1], [0, 0, 0, 0, 0, 0]], bool)
    np.testing.assert_array_equal(following._mean_run(state), [1.5, 6.0, np.nan])
    np.testing.assert_array_equal(following._mean_run(state[:, :0]), [np.nan] * 3)


def test_behind_is_what_scipy_and_a_loop_say():
    rng = np.random.default_rng(4)
    place, radius = rng.uniform(-2, 2, (14, 20, 2)), rng.uniform(0.05, 0.25, 14)
    left, active = rng.uniform(0, 9, (14, 20)), rng.random((14, 20)) < 0.8
    found = following.behind(place, left, active, radius)
    for k in range(20):
        who = np.flatnonzero(active[:, k])
        p, r = place[who, k], radius[who]
        linked = np.hypot(*(p[:, None] - p[None]).transpose(2, 0, 1)) <= 3 * (r[:, None] + r)
        _, label = connected_components(linked)
        size = np.bincount(label)[label]
        mean = left[who, k][size == size.max()].mean()
        expected = np.zeros(14, bool)
        expected[who] = (size < size.max()) & (left[who, k] > mean)
        np.testing.assert_array_equal(found[:, k], expected)
    assert found.any()
