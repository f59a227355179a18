"""The collision probability (Eq. 22-24): by hand, against its twin, and from every side."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from benchnav.arena.solid import Kind
from benchnav.envs.collision_probability import collision_probability, probability
from benchnav.sensors.readings import Neighbours
from tests.reference import collision as slow

coordinates = st.floats(-10, 10)
speeds = st.floats(-3, 3)
reaches = st.floats(0.2, 2)
angles = st.floats(-math.pi, math.pi)


@pytest.mark.parametrize(
    ("offset", "velocity", "reach", "expected"),
    [
        ((5, 0), (2, 0), 1, 0.5),  # a gap of 4 m at 2 m/s
        ((9, 0), (2, 0), 1, 0.25),
        ((0, -4), (0, -1), 1, 1 / 3),
        ((5, 0.6), (1, 0), 1, 1 / 4.2),  # 0.8 before the centre, off its axis
        ((2, 0), (2, 0), 1, 1),  # half a second
        ((3, 0), (2, 0), 1, 1),  # a second
        ((0.5, 0), (0, 0), 1, 1),  # overlap, standing
        ((0.5, 0), (-3, 0), 1, 1),  # overlap, leaving
        ((1, 0), (-1, 0), 1, 1),  # touching counts as overlap
        ((0, 0), (0, 0), 1, 1),
        ((5, 0), (0, 2), 1, 0),  # outside the cone
        ((5, 1.1), (2, 0), 1, 0),  # past it by 10 cm
        ((5, 0), (-2, 0), 1, 0),  # leaving: behind on the line, not on the ray
        ((5, 0), (0, 0), 1, 0),
    ],
)
def test_by_hand(offset, velocity, reach, expected):
    assert probability(*map(float, (*offset, *velocity, reach))) == pytest.approx(expected)


def test_half_a_second_earlier_the_gap_is_half_a_second_longer():
    late, early = (1 / probability(x, 0.3, 1.5, 0.0, 1.0) for x in (6.0, 6.75))
    assert early - late == pytest.approx(0.5)


def clear_of_edges(offset, velocity, reach):
    """Rounding decides neither the overlap nor whether the ray grazes."""
    assume(abs(np.hypot(*offset) - reach) > 1e-3)
    speed = np.hypot(*velocity)
    assume(speed > 1e-3)
    across = abs(offset[0] * velocity[1] - offset[1] * velocity[0]) / speed
    assume(abs(across - reach) > 1e-3)


@given(coordinates, coordinates, speeds, speeds, reaches)
def test_agrees_with_its_twin(x, y, vx, vy, reach):
    offset, velocity = np.array([x, y]), np.array([vx, vy])
    clear_of_edges(offset, velocity, reach)
    expected = slow.probability(offset, velocity, reach)
    assert probability(x, y, vx, vy, reach) == pytest.approx(expected, rel=1e-6)


@given(coordinates, coordinates, speeds, speeds, reaches, angles)
def test_is_blind_to_direction_handedness_and_sides(x, y, vx, vy, reach, angle):
    offset, velocity = np.array([x, y]), np.array([vx, vy])
    clear_of_edges(offset, velocity, reach)
    p = probability(x, y, vx, vy, reach)
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    assert probability(*turn @ offset, *turn @ velocity, reach) == pytest.approx(p)
    assert probability(x, -y, vx, -vy, reach) == p
    assert probability(-x, -y, -vx, -vy, reach) == p  # as the mover sees the agent


@given(coordinates, coordinates, speeds, speeds, reaches)
def test_is_a_probability(x, y, vx, vy, reach):
    assert 0.0 <= probability(x, y, vx, vy, reach) <= 1.0


def crowd(seed, B=3, A=4, K=5):
    rng = np.random.default_rng(seed)
    position = rng.uniform(-5, 5, (B, A, 2))
    velocity, radius = rng.uniform(-2, 2, (B, A, 2)), rng.uniform(0.2, 0.6, (B, A))
    kind = rng.choice([int(Kind.AGENT), int(Kind.DYNAMIC)], (B, A, K)).astype(np.int8)
    seen = Neighbours(
        rng.uniform(-5, 5, (B, A, K, 2)), rng.uniform(-2, 2, (B, A, K, 2)),
        rng.uniform(0.2, 0.8, (B, A, K)), kind, rng.integers(0, K + 1, (B, A)),
    )  # fmt: skip
    return position, velocity, radius, seen


@pytest.mark.parametrize("seed", range(20))
def test_a_batch_agrees_with_its_twin(seed):
    case = crowd(seed)
    np.testing.assert_allclose(collision_probability(*case), slow.highest(*case), rtol=1e-6)


def head_on(kinds, count, x=5.0):
    K = len(kinds)
    place = np.zeros((1, 1, K, 2))
    place[..., 0] = x + 4.0 * np.arange(K)  # the first is the nearest
    seen = Neighbours(
        place, np.zeros((1, 1, K, 2)), np.full((1, 1, K), 0.5),
        np.array([[kinds]], np.int8), np.array([[count]]),
    )  # fmt: skip
    still = np.zeros((1, 1, 2))
    return collision_probability(still, still + np.array([2.0, 0.0]), np.full((1, 1), 0.5), seen)[
        0, 0
    ]


def test_only_movers_count():
    assert head_on([Kind.DYNAMIC, Kind.DYNAMIC], 2) == 0.5
    assert head_on([Kind.AGENT, Kind.DYNAMIC], 2) == 0.25
    assert head_on([Kind.AGENT, Kind.AGENT], 2) == 0


def test_padding_does_not_count():
    assert head_on([Kind.DYNAMIC, Kind.DYNAMIC], 0) == 0
    assert head_on([Kind.AGENT, Kind.DYNAMIC], 1) == 0


def test_the_highest_counts_whatever_the_order():
    position, velocity, radius, seen = crowd(3)
    order = np.argsort(np.where(np.arange(5) < seen.count[..., None], -np.arange(5), 9), axis=-1)
    mixed = Neighbours(
        *(np.take_along_axis(a, order[..., None], 2) for a in (seen.position, seen.velocity)),
        *(np.take_along_axis(a, order, 2) for a in (seen.radius, seen.kind)), seen.count,
    )  # fmt: skip
    np.testing.assert_array_equal(
        collision_probability(position, velocity, radius, seen),
        collision_probability(position, velocity, radius, mixed),
    )


def test_who_sees_nobody_is_safe():
    nobody = np.zeros((2, 3, 2))
    none = Neighbours(
        np.zeros((2, 3, 0, 2)), np.zeros((2, 3, 0, 2)), np.zeros((2, 3, 0)),
        np.zeros((2, 3, 0), np.int8), np.zeros((2, 3), np.int64),
    )  # fmt: skip
    assert not collision_probability(nobody, nobody, np.ones((2, 3)), none).any()
