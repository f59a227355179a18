"""Contacts and arrivals against a dense sampling of the same motion, and encounters of those who
come and go against the same encounters of those who are there all the time."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchnav.arena.solid import Kind, Solid
from benchnav.metrics.quantities.encounters import Things, encounters
from benchnav.metrics.quantities.trajectory import Trajectories
from benchnav.scoring.recorded_episode import write_arrivals
from benchnav.scoring.touches import RELEASE, TOUCH, touches

DT, FINE = 0.2, 400  # samples of a step
POST = Solid(Kind.STATIC, center=(0.5, 0.2), radius=0.4)
WALL = Solid(Kind.WALL, (np.array([[-2.0, 1.5], [2.0, 1.5], [2.0, 1.7], [-2.0, 1.7]]),))
NO_MOVERS = np.empty((0, 6))
NOTHING = Things(np.zeros((0, 5)), np.zeros(0, np.int64), np.zeros((0, 1, 2)), np.zeros(0, bool))


def tracks(seed, agents=4, states=15):
    """Positions (A, T+1, 2) of random walks, and their first and last states."""
    rng = np.random.default_rng(seed)
    place = rng.uniform(-1.5, 1.5, (agents, 1, 2)) + np.cumsum(
        rng.normal(0, 0.25, (agents, states, 2)), axis=1
    )
    first = rng.integers(0, states // 3, agents)
    last = rng.integers(states // 2, states, agents)
    for a in range(agents):
        place[a, : first[a]], place[a, last[a] :] = place[a, first[a]], place[a, last[a]]
    return place, first, last


def sampled(place, low, high):
    """Times and positions between two states."""
    times = np.arange(low * FINE, high * FINE + 1) / FINE
    k = np.minimum(times.astype(int), place.shape[1] - 2)
    share = (times - k)[:, None]
    return times * DT, place[:, k] * (1 - share) + place[:, k + 1] * share


def intervals(times, gap):
    """Maximal intervals that begin at an overlap and end at a gap above RELEASE."""
    found, start = [], None
    for time, value in zip(times, gap, strict=True):
        if start is None and value <= TOUCH:
            start = time
        elif start is not None and value > RELEASE:
            found.append((start, time))
            start = None
    return found if start is None else [*found, (start, times[-1])]


def distance(points, solid):
    """Distance (N,) of points (N, 2) from the edge of a solid."""
    least = np.full(len(points), np.inf)
    for x0, y0, x1, y1, r in solid.capsules:
        a, d = np.array([x0, y0]), np.array([x1 - x0, y1 - y0])
        t = np.clip((points - a) @ d / max(d @ d, 1e-12), 0, 1)
        least = np.minimum(least, np.hypot(*(points - a - t[:, None] * d).T) - r)
    return least


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10_000))
def test_contacts_are_those_of_a_dense_sampling(seed):
    place, first, last = tracks(seed)
    radius = np.random.default_rng(seed + 1).uniform(0.1, 0.4, len(place))
    stop = np.full(len(place), np.inf)
    found = touches(place, first, last, DT, last * DT, radius, (WALL, POST), stop, NO_MOVERS)
    expected = {}
    for i in range(len(place)):
        for j in range(len(place)):
            low, high = max(first[i], first[j]), min(last[i], last[j])
            if i != j and low < high:
                times, points = sampled(place, low, high)
                gap = np.hypot(*(points[i] - points[j]).T) - radius[i] - radius[j]
                expected[i, int(Kind.AGENT), j] = intervals(times, gap), gap
        for number, solid in enumerate((WALL, POST)):
            times, points = sampled(place, first[i], last[i])
            gap = distance(points[i], solid) - radius[i]
            expected[i, int(solid.kind), number] = intervals(times, gap), gap
    for key, (wanted, gap) in expected.items():
        mine = (found.agent == key[0]) & (found.kind == key[1]) & (found.partner == key[2])
        ours = np.stack([found.start[mine], found.end[mine]], axis=1)
        close = np.abs(gap - TOUCH).min(initial=1) < 2e-3 or np.abs(gap - RELEASE).min() < 2e-3
        if len(ours) == len(wanted) and len(ours):
            assert np.allclose(ours, wanted, atol=0.02) or close, (key, ours, wanted)
        else:
            assert len(ours) == len(wanted) or close, (key, ours, wanted)
        if len(ours):
            assert found.penetration[mine].max() >= -gap.min() - 1e-2
    assert (np.diff(found.agent) >= 0).all()


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10_000), st.floats(0.05, 1.0))
def test_arrivals_are_those_of_a_dense_sampling(seed, tolerance):
    place, first, last = tracks(seed)
    goal = np.random.default_rng(seed).uniform(-1.5, 1.5, (len(place), 2))
    arrival = np.full(len(place), np.nan)
    write_arrivals(place, first, last, last * DT, DT, goal, tolerance, arrival)
    for a in range(len(place)):
        times, points = sampled(place, first[a], last[a])
        away = np.hypot(*(points[a] - goal[a]).T) - tolerance
        inside = np.flatnonzero(away <= 0)
        if np.abs(away).min() > 2e-3 or len(inside):
            wanted = times[inside[0]] if len(inside) else np.nan
            later = np.isnan(arrival[a]) or abs(arrival[a] - wanted) < 2e-3
            assert later or arrival[a] < wanted  # a graze between two samples
            assert np.isnan(arrival[a]) == (len(inside) == 0) or np.abs(away).min() < 2e-3


def trajectories(place, first, last):
    """Trajectories of agents that move from their first to their last state."""
    steps = place.shape[1] - 1
    moves = np.arange(steps) < last[:, None]
    velocity = np.where(moves[..., None], np.diff(place, axis=1) / DT, 0.0)
    leaves = np.where(last < steps, last, steps + 1)
    return Trajectories(
        DT, last, last * DT, place, np.where(moves, DT, 0.0), velocity, leaves,
        np.ones(len(place)), np.ones(len(place), bool), enters=first,
    )  # fmt: skip


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10_000))
def test_nobody_meets_an_agent_that_is_not_there_yet(seed):
    place, first, last = tracks(seed, agents=2)
    low, high = int(max(first)), int(min(last))
    radius = np.array([0.2, 0.3])
    found = encounters(trajectories(place, first, last), radius, NOTHING)
    _, points = sampled(place, low, high)
    gap = np.hypot(*(points[0] - points[1]).T) - radius.sum()
    assert found.clearance.min() == pytest.approx(gap.min(), abs=5e-3)
    here = trajectories(place[:, low:], first * 0, last - low)
    alone = encounters(replace(here, enters=None), radius, NOTHING)
    assert np.array_equal(found.gap[:, low:], alone.gap)
    assert np.array_equal(found.clearance, alone.clearance)
    assert (found.gap[:, :low] >= alone.gap.max()).all() or low == 0
