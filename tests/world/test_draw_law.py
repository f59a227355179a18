import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter

from benchnav.arena.body import LawKind
from benchnav.generation.motion_law import draw_law, moved_law, place_at_start, recorded_laws, swept
from benchnav.scenario.law import Law as LawSpec

_SPEC = TypeAdapter(LawSpec)


def drawn(seed=0, **spec):
    return draw_law(_SPEC.validate_python(spec), np.random.default_rng(seed))


def position(law, t):
    """The position at any time, from its definition."""
    if law.kind == LawKind.CIRCLE:
        (center, (radius, phase)), rate = law.points, law.times[0]
        return center + radius * np.array([np.cos(phase + rate * t), np.sin(phase + rate * t)])
    t = t + law.phase
    if law.periodic:
        t = t % law.times[-1]
    return np.array([np.interp(t, law.times, law.points[:, k]) for k in (0, 1)])


def test_back_and_forth():
    law = drawn(type="back-and-forth", length=4, speed=0.5, direction=0, phase=0.25)
    np.testing.assert_allclose(law.points, [[-2, 0], [2, 0], [-2, 0]])
    np.testing.assert_allclose(law.times, [0, 8, 16])
    assert law.periodic
    assert law.phase == 4.0
    np.testing.assert_allclose(place_at_start(law), [0, 0])


def test_waypoint_loop():
    law = drawn(type="waypoint-loop", points=((0, 0), (3, 0), (3, 4)), speed=1, phase=0.5)
    np.testing.assert_allclose(law.times, [0, 3, 7, 12])
    np.testing.assert_allclose(law.points[-1], law.points[0])
    np.testing.assert_allclose(place_at_start(law), [3, 3])


@pytest.mark.parametrize("clockwise", [False, True])
def test_circle(clockwise):
    law = drawn(type="circle", radius=2, speed=1, phase=0.25, clockwise=clockwise)
    assert law.times[0] == (-0.5 if clockwise else 0.5)
    np.testing.assert_allclose(place_at_start(law), [0, 2], atol=1e-12)


def test_recorded_points():
    spec = {"type": "recorded-track", "points": ((1, 0, 0), (3, 2, 0)), "scale": 2,
            "offset": (1, 1)}  # fmt: skip
    (law,) = recorded_laws(_SPEC.validate_python(spec), None)
    np.testing.assert_allclose(law.times, [0, 1, 3])
    np.testing.assert_allclose(law.points, [[1, 1], [1, 1], [5, 1]])
    assert not law.periodic
    np.testing.assert_allclose(position(law, 99), [5, 1])


@given(st.integers(0, 10**6), st.sampled_from(["back-and-forth", "waypoint-loop", "circle"]))
def test_the_swept_path_covers_every_position(seed, kind):
    numbers = {
        "back-and-forth": {"length": {"uniform": (1, 8)}},
        "waypoint-loop": {"points": ((0, 0), (3, 1), (2, 4), (-1, 2))},
        "circle": {"radius": {"uniform": (0.2, 3)}},
    }[kind]
    law = drawn(seed, type=kind, speed={"uniform": (0.5, 1.5)}, **numbers)
    law = moved_law(law, np.array([3.0, -7.0]))
    np.testing.assert_allclose(position(law, 0.0), place_at_start(law), atol=1e-9)
    capsules = swept(law, 0.25)
    for t in np.linspace(0, 40, 60):
        p = position(law, t)
        a, b = capsules[:, 0:2], capsules[:, 2:4]
        along = np.sum((p - a) * (b - a), axis=1) / np.maximum(np.sum((b - a) ** 2, axis=1), 1e-12)
        nearest = a + np.clip(along, 0, 1)[:, None] * (b - a)
        distance = np.hypot(*(p - nearest).T) - capsules[:, 4]
        assert distance.min() <= -0.25 + 1e-9  # the whole disc of 0.25 m about it is covered
