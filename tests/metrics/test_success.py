"""Success, its edge cases, and success against horizon."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchnav.metrics import success
from benchnav.testing.episodes import Hit, Setting, Walk, record, straight
from benchnav.testing.zoo import zoo


def _one(hits=(), **changes):
    return record([Walk(straight((0.0, 0.0), (1.0, 0.0)), (5.0, 0.0), hits=tuple(hits))], **changes)


def test_contact_counts_only_before_arrival():
    at = float(_one().arrival[0])
    assert success.success(_one([Hit(at - 1e-6)])) == [0.0]
    assert success.success(_one([Hit(at)])) == [1.0]
    assert success.success(_one([Hit(at + 1.0)])) == [1.0]
    assert success.success(_one([Hit(1.0, charged=False)])) == [1.0]
    assert success.arrival(_one([Hit(1.0)])) == [1.0]


def test_every_evaluated_agent_has_one_outcome():
    """Arrived, timed out, ended or failed: the rates of these four add up to one."""
    for episode in zoo().values():
        ended = (episode.status[-1] == 2).astype(float)
        total = success.arrival(episode) + success.timeout(episode) + success.failed(episode)
        np.testing.assert_array_equal((total + ended)[episode.world.agents.evaluated], 1.0)
        assert (success.success(episode) <= success.arrival(episode)).all()
        assert (success.stuck(episode) <= success.timeout(episode)).all()


def test_stuck_means_the_last_ten_seconds():
    def halts(at, back=0.0):
        def path(t):
            x = np.minimum(t, at) - back * np.maximum(t - 15.0, 0.0)
            return np.stack([x, np.zeros_like(t)], axis=1)

        return record([Walk(path, (19.0, 0.0), radius=0.3)])

    assert success.stuck(halts(9.0)) == [1.0]
    assert success.stuck(halts(10.25)) == [1.0]  # moved 0.25 m since the tenth second
    assert success.stuck(halts(10.35)) == [0.0]
    assert success.stuck(halts(9.0, back=0.1)) == [0.0]


def test_stuck_is_undefined_in_a_shorter_horizon():
    walk = Walk(straight((0.0, 0.0), (0.0, 0.0)), (5.0, 0.0))
    assert np.isnan(success.stuck(record([walk], Setting(horizon=8.0)))).all()


def test_failed_agents_are_neither_timed_out_nor_stuck():
    episode = replace(record([Walk(straight((0.0, 0.0), (0.0, 0.0)), (5.0, 0.0), fails=2.0)]))
    assert success.failed(episode) == [1.0]
    assert success.timeout(episode) == success.stuck(episode) == [0.0]


def test_curve_keeps_failures_in_the_denominator():
    """Of four, one arrives at 2 s, one at 5 s, two never: it rises to a half, not to one."""
    times = np.array([5.0, math.inf, 2.0, math.inf])
    curve = success.success_by_horizon(times, np.array([0.0, 2.0, 4.9, 5.0, 100.0]))
    assert curve.tolist() == [0.0, 0.25, 0.25, 0.5, 0.5]
    assert np.isnan(success.success_by_horizon(np.zeros(0), np.array([1.0]))).all()


@given(
    st.lists(st.one_of(st.floats(0.0, 50.0), st.just(math.inf)), min_size=1, max_size=30),
    st.lists(st.floats(0.0, 60.0), min_size=1, max_size=10),
)
def test_curve_is_the_share_that_has_succeeded(times, horizons):
    horizons = sorted(horizons)
    curve = success.success_by_horizon(np.array(times), np.array(horizons))
    assert curve.tolist() == pytest.approx(
        [sum(t <= h for t in times) / len(times) for h in horizons]
    )
    assert (np.diff(curve) >= 0.0).all()


def test_success_time_is_what_the_curve_needs():
    episode = zoo()["smooth"]
    times = success.success_time(episode)
    curve = success.success_by_horizon(times, np.array([episode.world.clock.horizon]))
    assert curve[0] == success.success(episode).mean()
    assert times[0] == pytest.approx(8.8)
    assert math.isinf(times[1])
