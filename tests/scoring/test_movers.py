"""Contacts with moving obstacles, against a dense sampling of the same straight motion."""

import math

import numpy as np
import pytest

from benchnav.arena.body import Body, Law, LawKind, absent
from benchnav.arena.solid import Kind
from benchnav.scoring.movers import mover_contacts, mover_positions
from benchnav.verify.reference.reference_geometry import law_position
from tests.worlds import back_and_forth, box, disc

DT, FAR, SAMPLES = 0.2, 1e9, 60


def walker(times, points):
    return Body(disc(Kind.DYNAMIC, 0.0, 0.0, 0.3), Law(LawKind.TRACK, times, points))


def sampled(place, body, radius, states):
    """(start, end) of contacts of one agent with one obstacle, in `SAMPLES` samples a step."""
    laws = [law_position(body, k * DT, False) for k in range(states)]
    found = []
    for k in range(states - 1):
        if absent(laws[k]) or absent(laws[k + 1]):
            found += [False] * SAMPLES
            continue
        for s in np.arange(SAMPLES) / SAMPLES:
            p = place[k] + s * (place[k + 1] - place[k])
            q = laws[k] + s * (laws[k + 1] - laws[k])
            c = body.solid.capsules
            away = [distance(p - q, one[:2], one[2:4]) - one[4] for one in c]
            found.append(min(away) <= radius)
    edges = np.flatnonzero(np.diff([False, *found, False]))
    return edges.reshape(-1, 2) * DT / SAMPLES


def distance(p, a, b):
    d = b - a
    u = np.clip((p - a) @ d / max(d @ d, 1e-300), 0, 1)
    return math.hypot(*(p - a - u * d))


@pytest.mark.parametrize("seed", range(2))
def test_contacts_are_those_of_a_dense_sampling(seed):
    rng = np.random.default_rng(seed)
    shape = box(Kind.DYNAMIC, 0.0, 0.0, 0.4, 0.6)
    bodies = [back_and_forth(shape, (-3.0, 0.2 * k), (3.0, -0.4 * k), 1.0, k) for k in range(3)]
    states = 40
    place = np.cumsum(rng.normal(0.0, 0.15, (2, states, 2)), axis=1)
    first, last = np.zeros(2, np.int64), np.full(2, states - 1)
    position = mover_positions(bodies, states, DT)
    rows = mover_contacts(place, first, last, DT, np.full(2, 0.3), bodies, position)
    compared = 0
    for a in range(2):
        for m, body in enumerate(bodies):
            mine = rows[(rows[:, 0] == a) & (rows[:, 1] == -1 - m)]
            expected = sampled(place[a], body, 0.3, states)
            lengths = np.diff(expected, axis=1).sum()
            # a contact ends only at a gap of 0.01 m, so that two of them may be one
            assert mine.shape[0] <= len(expected) + 1
            assert np.isclose(mine[:1, 2], expected[:1, 0], atol=DT / SAMPLES).all()
            assert (mine[:, 3] - mine[:, 2]).sum() >= lengths - 0.1
            compared += len(expected)
    assert compared > 1


def test_a_person_who_is_gone_touches_nothing():
    away = [FAR, FAR]
    person = walker(
        np.array([0.0, 1.0, 1.0, 2.0, 2.0, 3.0]),
        np.array([away, away, [0.0, 0.0], [2.0, 0.0], away, away]),
    )
    states = 16
    position = mover_positions([person], states, DT)
    assert absent(position[:, 0]).tolist() == [k * DT < 1.0 or k * DT >= 2.0 for k in range(states)]
    still = np.zeros((1, states, 2)) + np.array([1.0, 0.0])
    first, last = np.zeros(1, np.int64), np.full(1, states - 1)
    (row,) = mover_contacts(still, first, last, DT, np.array([0.2]), [person], position)
    assert row[:2].tolist() == [0, -1]
    assert row[2] == pytest.approx(1.25, abs=0.06)
    assert row[5] == pytest.approx(2.0)
    beside = still + np.array([0.0, 3.0])  # on the way of the person who vanishes
    assert len(mover_contacts(beside, first, last, DT, np.array([0.2]), [person], position)) == 0
