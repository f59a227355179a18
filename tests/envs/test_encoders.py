"""Encoders: against their twins, within their ranges, and from wherever one looks."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from benchnav.arena.solid import Kind
from benchnav.envs.encoders.catalogue import ENCODERS, encoder
from benchnav.envs.encoders.encoder import Bodies
from benchnav.errors import UsageError
from benchnav.generation.build import build
from benchnav.navigation.navigator import Need
from benchnav.navigation.observation import Observation
from benchnav.scenario.catalogue import find
from benchnav.sensors.readings import Edges, Neighbours, Rays
from benchnav.testing.observations import observations_of
from tests.reference import encoders as slow

SENSORS = frozenset({Need.RAYS, Need.NEIGHBOURS, Need.EDGES})
SCENARIOS = ("leaders/dynamic", "corridor/bidirectional")


@cache
def sensed(scenario, worlds=3, frames=8):
    """Observations, and the bodies of those who observe."""
    drawn = [build(find(scenario), "train", seed) for seed in range(worlds)]
    width = max(len(world.agents) for world in drawn)
    limits = [np.ones((worlds, width)) for _ in range(3)]
    for array, name in zip(limits, ("radius", "max_speed", "max_turn_rate"), strict=True):
        for b, world in enumerate(drawn):
            array[b, : len(world.agents)] = getattr(world.agents, name)
    return observations_of(drawn, SENSORS, frames=frames), Bodies(*limits)


def imagined(seed=0, B=2, A=3, rays=7):
    """An observation of nothing that was ever simulated."""
    rng = np.random.default_rng(seed)
    shape = (B, A)
    kinds = [k for k in Kind if k != Kind.GOAL]
    kind = rng.choice(kinds, (*shape, rays)).astype(np.int8)
    distance = np.where(kind == Kind.NOTHING, 8.0, rng.uniform(0, 8, kind.shape))
    seen_rays = Rays(
        np.linspace(-math.pi / 2, math.pi / 2, rays), distance, kind,
        np.where(kind == Kind.DYNAMIC, rng.uniform(-2, 2, kind.shape), 0.0),
        np.where(rng.random(kind.shape) < 0.2, rng.uniform(0, 1, kind.shape) * distance, np.inf),
        across=np.where(kind == Kind.DYNAMIC, rng.uniform(-4, 4, kind.shape), 0.0),
    )  # fmt: skip
    position = rng.uniform(-9, 9, (*shape, 2))
    neighbours = Neighbours(
        position[:, :, None] + rng.uniform(-6, 6, (*shape, 8, 2)),
        rng.uniform(-2, 2, (*shape, 8, 2)), rng.uniform(0.3, 0.8, (*shape, 8)),
        rng.choice([int(Kind.AGENT), int(Kind.DYNAMIC)], (*shape, 8)).astype(np.int8),
        rng.integers(0, 9, shape),
    )  # fmt: skip
    first = position[:, :, None] + rng.uniform(-7, 7, (*shape, 10, 2))
    second = first + rng.uniform(-2, 2, first.shape)
    flags = np.zeros((*shape, 10), bool)
    edges = Edges(first, second, first, second, flags, flags, rng.integers(0, 11, shape))
    seen = Observation(
        rows=np.arange(B),
        time=np.zeros(B),
        active=np.ones(shape, bool),
        position=position,
        heading=rng.uniform(-math.pi, math.pi, shape),
        velocity=rng.uniform(-2, 2, (*shape, 2)),
        goal=rng.uniform(-9, 9, (*shape, 2)),
        maps=(None,) * B,
        rays=seen_rays,
        neighbours=neighbours,
        edges=edges,
    )
    return seen, Bodies(rng.uniform(0.2, 0.6, shape), rng.uniform(1, 2, shape), np.ones(shape))


def moved(seen, angle, offset):
    """The same view of a world that was turned, then moved."""
    c, s = math.cos(angle), math.sin(angle)

    def turned(vectors):
        return vectors @ np.array([[c, s], [-s, c]])

    def placed(points):
        return turned(points) + offset

    near, edges = seen.neighbours, seen.edges
    return replace(
        seen, position=placed(seen.position), goal=placed(seen.goal),
        velocity=turned(seen.velocity),
        heading=np.remainder(seen.heading + angle + math.pi, 2 * math.pi) - math.pi,
        neighbours=replace(
            near, position=placed(near.position), velocity=turned(near.velocity)
        ),
        edges=replace(edges, start=placed(edges.start), end=placed(edges.end)),
    )  # fmt: skip


def assert_twin(name, seen, bodies, every=1):
    chosen = encoder(name)
    fast = chosen.encode(seen, bodies)
    low, high = ([getattr(n, end) for n in chosen.numbers] for end in ("low", "high"))
    for at in np.argwhere(seen.active)[::every]:
        numbers = np.clip(slow.encode(name, seen, tuple(at), bodies), low, high)
        wrong = np.flatnonzero(np.abs(fast[tuple(at)] - numbers) > 2e-5)
        told = [(chosen.numbers[k].name, fast[tuple(at)][k], numbers[k]) for k in wrong]
        assert not told, (tuple(at), told)


@pytest.mark.parametrize("name", ENCODERS)
@pytest.mark.parametrize("scenario", SCENARIOS)
def test_agrees_with_its_twin_in_worlds(name, scenario):
    observations, bodies = sensed(scenario)
    every = 5 if name == "dynamic-window" else 2  # its twin is slow
    for seen in observations[::7]:
        assert_twin(name, seen, bodies, every)


@pytest.mark.parametrize("name", ENCODERS)
@pytest.mark.parametrize("seed", range(4))
def test_agrees_with_its_twin_in_imagined_views(name, seed):
    assert_twin(name, *imagined(seed))


@pytest.mark.parametrize(
    ("name", "width"),
    [
        ("paper", 62),
        ("ego", 62),
        ("near", 62),
        ("paper-static", 48),
        ("ego-static", 48),
        ("surround", 80),
        ("panorama", 160),
        ("dynamic-window", 295),
    ],
)
def test_widths(name, width):
    chosen = encoder(name)
    assert chosen.size == len(chosen.numbers) == width
    assert len({number.name for number in chosen.numbers}) == width
    assert chosen.encode(*imagined()).shape == (2, 3, width)


@pytest.mark.parametrize("name", ENCODERS)
@pytest.mark.parametrize("scenario", SCENARIOS)
def test_all_numbers_are_finite_and_within_their_ranges(name, scenario):
    observations, bodies = sensed(scenario)
    numbers = encoder(name).numbers
    for seen in observations:
        values = encoder(name).encode(seen, bodies)
        assert values.dtype == np.float32
        assert np.isfinite(values).all()
        assert (values >= [n.low for n in numbers]).all()
        assert (values <= [n.high for n in numbers]).all()


@pytest.mark.parametrize("name", ENCODERS)
def test_what_is_out_of_range_is_clipped(name):
    seen, bodies = imagined()
    far = replace(seen, goal=seen.position + np.array([1000.0, 0.0]), velocity=seen.velocity * 1000)
    numbers = encoder(name).numbers
    values = encoder(name).encode(far, bodies)
    assert (values >= [n.low for n in numbers]).all()
    assert (values <= [n.high for n in numbers]).all()


@pytest.mark.parametrize("angle", [0.0, 1.0, -2.5, math.pi / 2])
@pytest.mark.parametrize(
    "name", ["ego", "ego-static", "near", "surround", "panorama", "dynamic-window"]
)
def test_an_own_frame_is_blind_to_where_the_world_lies(name, angle):
    seen, bodies = imagined(1)
    there = moved(seen, angle, np.array([3.0, -4.0]))
    here = encoder(name).encode(seen, bodies)
    np.testing.assert_allclose(encoder(name).encode(there, bodies), here, atol=1e-5)


@pytest.mark.parametrize("name", ["paper", "paper-static"])
def test_the_paper_s_numbers_are_absolute(name):
    seen, bodies = imagined(1)
    here = encoder(name).encode(seen, bodies)
    for there in (moved(seen, 1.0, np.zeros(2)), moved(seen, 0.0, np.array([3.0, -4.0]))):
        changed = (encoder(name).encode(there, bodies) != here).any(axis=(0, 1))
        names = {encoder(name).numbers[k].name.split(".")[0] for k in np.flatnonzero(changed)}
        assert names <= {"p_a", "v_a", "p_g"}
        assert {"p_a", "p_g"} <= names


@pytest.mark.parametrize("name", ENCODERS)
@pytest.mark.parametrize("scenario", SCENARIOS)
def test_a_batch_of_one_is_the_single(name, scenario):
    observations, bodies = sensed(scenario)
    whole = encoder(name).encode(observations[-1], bodies)
    for b in range(len(whole)):
        one = Bodies(*(array[b : b + 1] for array in vars(bodies).values()))
        alone = encoder(name).encode(observations[-1].select(np.array([b])), one)
        np.testing.assert_array_equal(alone[0], whole[b])


@pytest.mark.parametrize("name", ["paper", "ego", "paper-static", "ego-static"])
def test_another_number_of_rays_is_refused(name):
    seen, bodies = imagined(rays=9)
    said = f"The encoder '{name.removesuffix('-static')}' was made for 7 rays an agent. Got"
    with pytest.raises(UsageError, match=f"{said} 9 instead"):
        encoder(name).encode(seen, bodies)
    with pytest.raises(UsageError, match=f"{said} none instead"):
        encoder(name).encode(replace(seen, rays=None), bodies)


def test_an_unknown_encoder_is_corrected():
    with pytest.raises(UsageError, match=r"Got 'suround' instead\. Did you mean 'surround'\?"):
        encoder("suround")


def of_one_ray(kind, distance, goal=np.inf, approach=0.0):
    """The seven numbers and two of a ray, of an agent whose rays all read the same."""
    seen, bodies = imagined(B=1, A=1)
    full = np.ones((1, 1, 7))
    rays = replace(
        seen.rays, kind=(full * int(kind)).astype(np.int8), distance=full * distance,
        goal=full * goal, approach=full * approach,
    )  # fmt: skip
    values = encoder("paper").encode(replace(seen, rays=rays), bodies)[0, 0]
    return values[:6].tolist(), values[48:50].tolist()


def test_a_ray_by_hand():
    assert of_one_ray(Kind.AGENT, 2.0) == ([1, 0, 0, 0, 0, 0.25], [0, 1])
    assert of_one_ray(Kind.WALL, 4.0) == ([0, 1, 0, 0, 0, 0.5], [0, 1])
    assert of_one_ray(Kind.STATIC, 8.0) == ([0, 0, 1, 0, 0, 1], [0, 1])
    assert of_one_ray(Kind.NOTHING, 8.0) == ([0, 0, 0, 0, 1, 1], [0, 1])
    assert of_one_ray(Kind.WALL, 4.0, goal=2.0) == ([0, 0, 0, 1, 0, 0.25], [0, 1])
    assert of_one_ray(Kind.DYNAMIC, 2.0, approach=1.0) == ([0, 0, 0, 0, 1, 1], [0.5, 0.25])
    in_front = of_one_ray(Kind.DYNAMIC, 4.0, goal=2.0, approach=-1.0)
    assert in_front == ([0, 0, 0, 1, 0, 0.25], [-0.5, 0.5])


def window(edge=False, other=None, speed=0.0):
    """The dynamic window {kind: (speeds, turns)} of an agent of 0.3 m that may drive 1 m/s.

    Ahead of it is an edge 2.35 m away, or another of 0.3 m, 3 m away, which drives ahead.
    """
    seen, _ = imagined(B=1, A=1)
    one = np.ones((1, 1, 1))
    at = {"position": np.zeros((1, 1, 2)), "heading": np.zeros((1, 1))}
    near = Neighbours(
        one[..., None] * [3.0, 0.0], one[..., None] * [speed, 0.0], 0.3 * one,
        (one * int(other or 0)).astype(np.int8), np.array([[int(other is not None)]]),
    )  # fmt: skip
    ends = [one[..., None] * [2.35, y] for y in (5.0, -5.0)]
    flags = np.zeros((1, 1, 1), bool)
    edges = Edges(*ends, *ends, flags, flags, np.array([[int(edge)]]))
    body = Bodies(np.full((1, 1), 0.3), np.ones((1, 1)), np.ones((1, 1)))
    values = encoder("dynamic-window").encode(
        replace(seen, neighbours=near, edges=edges, **at), body
    )
    return dict(zip(("short", "long", "back"), values[0, 0, 160:].reshape(3, 5, 9), strict=True))


def test_a_dynamic_window_by_hand():
    """Straight on is turn 4; contact with the edge counts from 2.35 m - 0.3 m - 0.05 m on."""
    wall = window(edge=True)
    for kind in ("short", "long"):
        assert wall[kind][4, 4] == pytest.approx(math.exp(-2.0 / 1.5))  # 2 m at 1 m/s
        assert wall[kind][3, 4] == pytest.approx(math.exp(-2.0 / 0.75 / 1.5))
        assert wall[kind][1, 4] == 0.0  # 8 s are beyond the horizon
        assert (wall[kind][0] == 0.0).all()
    assert wall["long"][4, 0] < wall["short"][4, 0] < wall["short"][4, 4]
    assert not wall["back"].any()
    leaving = window(other=Kind.DYNAMIC, speed=1.0)
    assert not leaving["short"].any()
    assert leaving["back"][0] == pytest.approx(math.exp(-2.35 / 1.5))
    assert leaving["back"][4, 4] == pytest.approx(math.exp(-2.35 / 2 / 1.5))
    agent = window(other=Kind.AGENT, speed=-1.0)
    assert agent["short"][0] == pytest.approx(math.exp(-2.35 / 1.5))
    assert not agent["back"].any()
