import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchnav.navigation.hierarchy.path_tracker import PathTracker, advanced
from benchnav.navigation.observation import Observation
from tests.reference import path_tracker as slow

STEP = 0.1


def seen(position, goal, rows=None, active=None):
    """An observation of (B, A, 2) positions and goals."""
    position, goal = np.array(position, float), np.array(goal, float)
    at = position.shape[:2]
    return Observation(
        rows=np.arange(at[0]) if rows is None else np.array(rows),
        time=np.zeros(at[0]),
        active=np.ones(at, bool) if active is None else np.array(active),
        position=position,
        heading=np.zeros(at),
        velocity=np.zeros((*at, 2)),
        goal=goal,
        maps=(None,) * at[0],
    )


def tracking(path, lookahead=1.0, cut=0.05):
    tracker = PathTracker(lookahead, cut)
    tracker.reset(0, np.array([STEP]))
    tracker.follow(0, 0, np.array(path, float))
    return tracker


def ask(tracker, x, goal=(99.0, 99.0)):
    guide = tracker.guide(seen([[x]], [[goal]]))
    return guide.target[0, 0], float(guide.remaining[0, 0])


def drive(tracker, path, steps):
    """Positions of an agent that goes to its target, a step at a time."""
    x, trace = np.array(path[0], float), []
    for _ in range(steps):
        trace.append(x)
        target, _ = ask(tracker, x, path[-1])
        offset = target - x
        x = x + offset * min(1.0, STEP / max(np.hypot(*offset), 1e-12))
    return np.array(trace)


def off_path(path, x):
    path = np.array(path, float)
    a, b = path[:-1], path[1:]
    t = np.clip(((x - a) * (b - a)).sum(1) / ((b - a) ** 2).sum(1), 0, 1)
    return np.hypot(*(x - a - t[:, None] * (b - a)).T).min()


def test_on_a_straight_path_the_target_is_a_lookahead_ahead():
    target, remaining = ask(tracking([(0, 0), (10, 0)]), (2.0, 0.5))
    np.testing.assert_allclose(target, (3.0, 0.0))
    assert remaining == pytest.approx(8.0)


def test_the_target_never_slows_the_agent_on_a_straight_path():
    tracker = PathTracker(0.01, 0.05)
    tracker.reset(0, np.array([0.4]))
    tracker.follow(0, 0, np.array([(0, 0), (10, 0)], float))
    np.testing.assert_allclose(ask(tracker, (2.0, 0.0))[0], (2.8, 0.0))


def test_the_end_of_the_path_leads_to_the_goal():
    tracker = tracking([(0, 0), (10, 0)])
    np.testing.assert_allclose(ask(tracker, (9.5, 0.0), (10.1, 0.0))[0], (10.0, 0.0))
    target, remaining = ask(tracker, (10.0, 0.01), (10.1, 0.0))
    np.testing.assert_allclose(target, (10.1, 0.0))
    assert remaining == 0.0


def test_a_corner_is_the_target_until_it_is_near():
    tracker = tracking([(0, 0), (5, 0), (5, 5)], cut=0.05)
    far, _ = ask(tracker, (4.5, 0.0))
    assert np.hypot(*(far - (5, 0))) < 0.12
    near, _ = ask(tracker, (4.96, 0.0))
    np.testing.assert_allclose(near, (5.0, 1.0))


@pytest.mark.parametrize("path", [np.zeros((0, 2)), np.ones((1, 2)), np.ones((3, 2))])
def test_without_a_way_to_go_the_target_is_the_goal(path):
    tracker = tracking(path)
    guide = tracker.guide(seen([[(1.0, 1.0)]], [[(4.0, 5.0)]]))
    np.testing.assert_array_equal(guide.target, [[(4.0, 5.0)]])
    assert guide.remaining[0, 0] == pytest.approx(5.0)
    assert guide.has_path[0, 0] == (len(path) > 0)


def test_repeated_waypoints_are_one():
    plain, doubled = tracking([(0, 0), (5, 0), (5, 5)]), tracking([(0, 0), (5, 0), (5, 0), (5, 5)])
    for x in ((1.0, 0.2), (4.9, 0.1), (5.0, 2.0)):
        assert ask(plain, x)[1] == ask(doubled, x)[1]


def test_a_path_that_comes_back_behind_a_wall_is_not_jumped_to():
    """The way back lies 0.4 m beside the way there, a thin wall between them."""
    path = [(0, 0), (10, 0), (10, 0.4), (0, 0.4)]
    tracker = tracking(path)
    _, start = ask(tracker, (2.0, 0.0))
    for y in (0.1, 0.19, 0.25, 0.39):  # nearer and nearer to the way back
        target, remaining = ask(tracker, (2.0, y))
        assert remaining == start
        np.testing.assert_allclose(target, (3.0, 0.0))


def test_pushed_past_a_corner_it_goes_on():
    tracker = tracking([(0, 0), (5, 0), (5, 5)])
    target, remaining = ask(tracker, (5.8, 1.0))
    assert remaining == pytest.approx(4.0)
    np.testing.assert_allclose(target, (5.0, 2.0))


grid = st.tuples(st.integers(-4, 4), st.integers(-4, 4)).map(lambda p: (float(p[0]), float(p[1])))
paths = (
    st.lists(grid, min_size=2, max_size=7)
    .map(lambda path: [p for i, p in enumerate(path) if i == 0 or p != path[i - 1]])
    .filter(lambda path: len(path) > 1)
)


@settings(max_examples=60, deadline=None)
@given(paths, st.sampled_from([0.3, 1.0, 3.0]), st.sampled_from([0.02, 0.1]))
def test_any_path_is_followed_closely_to_its_end(path, lookahead, cut):
    length = slow.length_at(np.array(path))[-1]
    trace = drive(tracking(path, lookahead, cut), path, int(2 * length / STEP) + 20)
    assert np.hypot(*(trace[-1] - path[-1])) < 1e-9
    assert max(off_path(path, x) for x in trace[::3]) <= cut + 1e-9


@settings(max_examples=60, deadline=None)
@given(paths, st.lists(grid, min_size=1, max_size=8), st.sampled_from([0.05, 0.5]))
def test_progress_never_falls_and_equals_the_slow_twin(path, visits, cut):
    tracker, way = tracking(path, cut=cut), np.array(path)
    length, k, s = slow.length_at(way)[-1], 0, 0.0
    for x in visits:
        x = np.array(x) + np.array([0.013, 0.0171])  # off every line through two grid points
        _, remaining = ask(tracker, x)
        k, expected = slow.progress(way, k, s, x, cut)
        assert length - remaining == pytest.approx(expected, abs=1e-9)
        assert expected >= s
        s = expected


def test_targets_equal_the_slow_twin():
    rng = np.random.default_rng(2)
    for _ in range(40):
        path = np.cumsum(rng.normal(0, 1, (6, 2)), axis=0)
        tracker, cut = tracking(path, 2.0, 0.2), 0.2
        x = path[1] + rng.normal(0, 0.3, 2)
        target, _ = ask(tracker, x)
        arc = slow.length_at(path)
        k, s = advanced(path, arc, len(path), 0, 0.0, *x, cut)
        expected = slow.target(path, k, s, x, 2.0, cut)
        np.testing.assert_allclose(target, expected, atol=2e-3)


def test_rows_and_agents_do_not_leak_whatever_the_batch():
    rng = np.random.default_rng(3)
    made = {
        (r, a): np.cumsum(rng.normal(0, 1, (3 + r + a, 2)), axis=0) for r in (0, 4) for a in (0, 1)
    }
    goal = rng.normal(0, 1, (2, 2, 2))
    both = PathTracker(1.0, 0.1)
    for row in (0, 4):
        both.reset(row, np.full(2, STEP))
        for agent in (0, 1):
            both.follow(row, agent, made[row, agent])
    position = rng.normal(0, 1, (5, 2, 2, 2))
    for at in position:
        together = both.guide(seen(at[::-1], goal, rows=[4, 0]))
    for place, row in enumerate((0, 4)):
        for agent in (0, 1):
            alone = tracking(made[row, agent], 1.0, 0.1)
            for at in position:
                target, remaining = ask(alone, at[place, agent], goal[1 - place, agent])
            np.testing.assert_array_equal(together.target[1 - place, agent], target)
            assert together.remaining[1 - place, agent] == remaining


def test_inactive_agents_make_no_progress():
    tracker = tracking([(0, 0), (10, 0)])
    tracker.guide(seen([[(5.0, 0.0)]], [[(10.0, 0.0)]], active=[[False]]))
    assert ask(tracker, (1.0, 0.0))[1] == pytest.approx(9.0)


def test_reset_forgets():
    tracker = tracking([(0, 0), (10, 0)])
    tracker.reset(0, np.array([STEP, STEP, STEP]))
    guide = tracker.guide(seen(np.zeros((1, 3, 2)), np.ones((1, 3, 2))))
    assert not guide.has_path.any()
    np.testing.assert_array_equal(guide.target, np.ones((1, 3, 2)))
