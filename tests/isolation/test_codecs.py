"""What a process is told and shown is what the runner had, to the last bit."""

from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest

from benchnav.arena.mesh import Mesh
from benchnav.arena.solid import Kind
from benchnav.isolation.briefing_codec import decode_briefings, encode_briefings
from benchnav.isolation.frame import HEAD, decode, encode, head
from benchnav.isolation.observation_codec import (
    decode_changed_maps,
    decode_observation,
    encode_observation,
)
from benchnav.navigation.map import Map
from benchnav.navigation.navigator import ALL_DYNAMICS, Need
from benchnav.navigation.randomness.agent_streams import agent_streams
from benchnav.navigation.randomness.briefing_seed import hashed_generator, seed_bytes
from benchnav.navigation.rehearsal import Rehearsal
from benchnav.runner.rollouts.seeding import generator
from benchnav.testing.observations import briefings_of as scene_briefings
from benchnav.testing.observations import observations_of
from benchnav.testing.scenes import scene, with_bodies
from tests.worlds import box, disc, walls

EVERYTHING = frozenset(Need)


def through(message):
    frame = encode("x", message)
    _, count, _ = head(frame)
    return decode(count, bytearray(frame[HEAD.size :]))


def same(one, other, name=""):
    """Fails where two things of the domain differ in anything but their generators."""
    if isinstance(one, np.random.Generator):
        return
    if is_dataclass(one):
        assert type(one) is type(other), name
        for f in fields(one):
            same(getattr(one, f.name), getattr(other, f.name), f"{name}.{f.name}")
    elif isinstance(one, np.ndarray):
        assert (one.dtype, one.shape) == (other.dtype, other.shape), name
        assert one.tobytes() == other.tobytes(), name
    elif isinstance(one, tuple):
        assert len(one) == len(other), name
        for k, pair in enumerate(zip(one, other, strict=True)):
            same(*pair, f"{name}[{k}]")
    else:
        assert one == other, name
        assert type(one) is type(other), name


def rehearsal(leaders, times):
    rng = np.random.default_rng(leaders)
    return Rehearsal(
        0.2, np.arange(leaders), rng.normal(size=(times, leaders, 2)), np.full(leaders, times - 1),
        np.where(np.arange(leaders) % 2 == 0, 3.0, np.nan), np.arange(leaders) % 2 == 1,
    )  # fmt: skip


def maps():
    mesh = Mesh(np.arange(12.0).reshape(4, 3), np.array([[0, 1, 2], [1, 2, 3]]), (0.1, 1.8))
    hollow = replace(
        walls(5.0), loops=(*walls(9.0).loops, *box(Kind.WALL, 1.0, 1.0, 0.5, 0.5).loops)
    )
    return [
        None,
        Map((0.0, 0.0, 9.0, 9.0), ()),
        Map(
            (-1.0, 0.0, 9.0, 9.0),
            (hollow, disc(Kind.STATIC, 1.0, 2.0, 0.5), box(Kind.STATIC, 4.0, 4.0, 1.0, 1.0)),
            4,
        ),
        Map((0.0, 0.0, 1.0, 1.0), (disc(Kind.STATIC, 0.1, 0.2, 0.3),), 0, (mesh, mesh)),
    ]


def briefings():
    some = scene_briefings((scene(1, 3), scene(2, 5), scene(3, 1), scene(4, 2)), EVERYTHING)
    grants = [(), (rehearsal(2, 5), rehearsal(3, 1)), (), (rehearsal(1, 9),)]
    budgets = [None, 0.1, 0.2, None]
    return [
        replace(b, map=m, rehearsals=g, decision_budget=d, rng=generator("00", "h", "test", k, 0))
        for k, (b, m, g, d) in enumerate(zip(some, maps(), grants, budgets, strict=True))
    ]


def test_briefings_come_back():
    rows = np.array([3, 0, 7, 1])
    got = through(encode_briefings(briefings(), rows))
    assert got["rows"].tolist() == rows.tolist()
    same(tuple(briefings()), tuple(decode_briefings(got)), "briefings")


def test_briefings_without_rehearsals_or_maps_come_back():
    plain = [replace(b, map=None, rehearsals=()) for b in briefings()]
    same(
        tuple(plain),
        tuple(decode_briefings(through(encode_briefings(plain, np.arange(4))))),
        "briefings",
    )


def test_maps_are_read_only_there_too():
    got = decode_briefings(through(encode_briefings(briefings(), np.arange(4))))
    with pytest.raises(ValueError, match="read-only"):
        got[2].map.solids[0].loops[0][0, 0] = 5.0
    with pytest.raises(ValueError, match="read-only"):
        got[2].map.solids[1].capsules[0, 0] = 5.0


def test_generators_draw_and_spawn_alike():
    here, there = (
        briefings()[1],
        decode_briefings(through(encode_briefings(briefings(), np.arange(4))))[1],
    )
    assert here.rng.normal(size=5).tolist() == there.rng.normal(size=5).tolist()
    children = zip(agent_streams(here), agent_streams(there), strict=True)
    assert all(a.random() == b.random() for a, b in children)


def test_what_was_drawn_from_before_goes_on_and_is_not_repeated():
    used = hashed_generator(bytes(range(32)))
    used.random()
    assert seed_bytes(used) not in (bytes(range(32)), seed_bytes(used))
    spawned = hashed_generator(bytes(range(32)))
    spawned.spawn(1)
    assert seed_bytes(spawned) != bytes(range(32))
    other = np.random.default_rng(1)
    assert len(seed_bytes(other)) == 32


@pytest.mark.parametrize("needs", [EVERYTHING, frozenset(), frozenset({Need.RAYS})])
def test_observations_come_back(needs):
    worlds = (scene(1, 3), scene(2, 5), scene(3, 1))
    come_back(observations_of(worlds, needs))


def test_observations_of_cars_and_capsules_come_back():
    worlds = [with_bodies(scene(seed, 4), ALL_DYNAMICS) for seed in range(3)]
    seen = observations_of(worlds, EVERYTHING)
    assert seen[-1].steering.any()
    assert seen[-1].neighbours.rounding.any()
    come_back(seen)


def come_back(observations):
    for observation in observations:
        shown = replace(observation, maps=tuple(maps()[:3]))
        held = dict(zip(shown.rows.tolist(), shown.maps, strict=True))
        same(shown, decode_observation(through(encode_observation(shown, ())), held), "observation")


def test_maps_are_sent_where_they_changed_alone():
    observation = next(iter(observations_of((scene(1, 3), scene(2, 5)), frozenset())))
    shown = replace(observation, maps=tuple(maps()[2:]))
    assert decode_changed_maps(through(encode_observation(shown, ()))) == {}
    got = decode_changed_maps(through(encode_observation(shown, [1])))
    assert list(got) == [int(shown.rows[1])]
    same(shown.maps[1], got[int(shown.rows[1])], "map")
