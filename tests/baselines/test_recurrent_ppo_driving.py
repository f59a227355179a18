"""What a learned driver keeps in mind, and what it does where it cannot get on."""

import math
from dataclasses import replace

import numpy as np
import pytest
from benchnav_baselines.learned.recurrent_ppo import detour, policy_at_work
from benchnav_baselines.learned.recurrent_ppo.detour import Detours
from benchnav_baselines.learned.recurrent_ppo.foresight import foresee
from benchnav_baselines.learned.recurrent_ppo.policy_at_work import PolicyPilot
from benchnav_baselines.learned.recurrent_ppo.sightings import MEMORY, Sightings
from benchnav_baselines.learned.recurrent_ppo.weights import write_weights

from benchnav.arena.solid import Kind
from benchnav.envs.encoders.catalogue import encoder
from benchnav.envs.encoders.encoder import Bodies
from benchnav.errors import PluginError
from benchnav.navigation.navigator import Need
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import NAVIGATORS
from benchnav.testing.observations import briefings_of, observations_of
from benchnav.testing.scenes import USUAL, scene
from tests.reference import detour as slow_detour
from tests.reference import sightings as slow_sightings

SENSORS = frozenset({Need.RAYS, Need.NEIGHBOURS, Need.EDGES})


@pytest.fixture(scope="module")
def shown():
    """(briefings, observations, bodies) of some decisions in three worlds."""
    worlds = [replace(scene(k, 6), sensing=USUAL) for k in range(3)]
    told = briefings_of(worlds, SENSORS)
    limits = [
        np.array([getattr(t, name) for t in told])
        for name in ("radius", "max_speed", "max_turn_rate")
    ]
    return told, list(observations_of(worlds, SENSORS, frames=20)), Bodies(*limits)


def begun(part, told):
    """What keeps something of each world, at the beginning of all of them."""
    for row, one in enumerate(told):
        part.reset(row, one)
    return part


def seeing(told, **kind):
    """Sightings of which nothing is remembered yet."""
    mine = Sightings(**kind)
    for row, one in enumerate(told):
        mine.forget(row, len(one), one.dt)
    return mine


def standing(seen, time, kind=Kind.DYNAMIC):
    """The same view, later, with neighbours of one kind."""
    kinds = np.full_like(seen.neighbours.kind, int(kind))
    return replace(
        seen, time=np.full(len(seen), time), neighbours=replace(seen.neighbours, kind=kinds)
    )


def assert_others(near, expected, b, a):
    """Agent (b, a) is told of exactly the ``expected`` others."""
    assert near.count[b, a] == len(expected)
    for n, (kind, place, velocity, size, _) in enumerate(expected):
        assert (near.kind[b, a, n], near.radius[b, a, n]) == (kind, size)
        np.testing.assert_allclose(near.position[b, a, n], place, atol=1e-9)
        np.testing.assert_allclose(near.velocity[b, a, n], velocity, atol=1e-9)


def test_sightings_agree_with_their_twin(shown):
    told, views, bodies = shown
    mine = seeing(told)
    kept, remembered, hidden = {}, 0, 0
    for seen in views:
        found = mine.recall(seen)
        for b, a in np.argwhere(seen.active):
            radius, dt = bodies.radius[b, a], told[b].dt
            kept[b, a] = slow_sightings.others(seen, radius, dt, kept.get((b, a), []), b, a)
            assert_others(found.neighbours, kept[b, a], b, a)
            edges, E = found.edges, found.edges.count[b, a]
            pairs = list(zip(edges.start[b, a, :E], edges.end[b, a, :E], strict=True))
            np.testing.assert_array_equal(
                np.reshape(pairs, (-1, 4)),
                np.reshape(slow_sightings.edges(seen, radius, b, a), (-1, 4)),
            )
            remembered += sum(one[-1] > 0 for one in kept[b, a])
            hidden += seen.edges.count[b, a] - E
    assert remembered > 10
    assert hidden > 10


def test_without_rays_all_in_sight_are_met_and_hidden_movers_remembered(shown):
    told, views, _ = shown
    mine = seeing(told, rays=False)
    kept, remembered, reordered = {}, 0, 0
    for seen in views:
        found = mine.recall(seen)
        assert not found.neighbours.count[~seen.active].any()
        for b, a in np.argwhere(seen.active):
            kept[b, a] = slow_sightings.seen_others(seen, told[b].dt, kept.get((b, a), []), b, a)
            nearest = sorted(kept[b, a], key=lambda one: math.dist(one[1], seen.position[b, a]))
            assert_others(found.neighbours, nearest, b, a)
            reordered += [*map(id, nearest)] != [*map(id, kept[b, a])]
            remembered += sum(one[-1] > 0 for one in kept[b, a])
        assert found.edges is seen.edges
    assert remembered > 3
    assert reordered > 0


def test_who_is_not_met_again_is_forgotten(shown):
    told, views, _ = shown
    mine = seeing(told)
    before = mine.recall(views[0]).neighbours.count.sum()
    assert before > 0
    blind = replace(views[0], rays=replace(views[0].rays, kind=np.zeros_like(views[0].rays.kind)))
    for _ in range(math.floor(MEMORY / told[0].dt)):
        count = mine.recall(blind).neighbours.count.sum()
    assert count == before
    assert mine.recall(blind).neighbours.count.sum() == 0


def test_what_no_ray_met_changes_no_command(shown):
    """Somebody stands right ahead, whom foresight would heed and no ray tells of."""
    told, views, bodies = shown
    seen = views[0]
    nothing = np.zeros_like(seen.rays.kind)
    ahead = np.stack([np.cos(seen.heading), np.sin(seen.heading)], axis=-1)
    place = np.broadcast_to((seen.position + ahead)[:, :, None], seen.neighbours.position.shape)
    others = replace(
        seen.neighbours, position=place.copy(), velocity=np.zeros_like(place),
        kind=np.full_like(seen.neighbours.kind, int(Kind.AGENT)),
        count=np.ones_like(seen.neighbours.count),
    )  # fmt: skip
    blind = replace(seen, rays=replace(seen.rays, kind=nothing), neighbours=others)
    alone = replace(
        blind,
        neighbours=replace(others, count=np.zeros_like(others.count)),
        edges=replace(seen.edges, count=np.zeros_like(seen.edges.count)),
    )
    commands = []
    for view in (blind, alone):
        driver = make(NAVIGATORS, "recurrent-ppo-vo")
        driver.reset(told, np.arange(3))
        commands.append(driver.act(view))
    np.testing.assert_array_equal(*commands)
    full = np.stack([bodies.max_speed, np.zeros_like(bodies.max_speed)], axis=-1)
    heeded = foresee(blind, bodies, full, np.zeros_like(bodies.radius))
    assert (heeded != full).any(axis=-1)[seen.active].all()


def test_who_stands_takes_the_way_that_its_twin_takes(shown):
    told, views, bodies = shown
    seen, dt = views[3], told[0].dt
    mine = begun(Detours(patience=1.0), told)
    still = np.zeros((*seen.active.shape, 2))
    command = still.copy()
    for k in range(round(1.0 / dt) + 1):
        assert (command == still).all()
        command = still.copy()
        mine.steer(standing(seen, k * dt), bodies, command)
    for b, a in np.argwhere(seen.active):
        course = slow_detour.course(seen, bodies.radius[b, a], b, a)
        error = math.remainder(course - seen.heading[b, a], 2 * math.pi)
        rate = bodies.max_turn_rate[b, a]
        expected = [
            bodies.max_speed[b, a] * max(0.0, math.cos(error)),
            min(max(error / dt, -rate), rate),
        ]
        np.testing.assert_allclose(command[b, a], expected, atol=1e-9)
    assert (command[~seen.active] == 0.0).all()


def test_a_second_detour_from_there_is_another_and_longer(shown):
    told, views, bodies = shown
    seen, dt = views[3], told[0].dt
    mine = begun(Detours(patience=1.0), told)
    courses, lengths = [], []
    for k in range(round(20.0 / dt)):
        command = np.full((*seen.active.shape, 2), -9.0)  # what nobody steers
        mine.steer(standing(seen, k * dt), bodies, command)
        away = bool((command[0, 0] != -9.0).any())
        if away and (not lengths or lengths[-1] < 0):
            courses.append(mine._kept.take("state", seen.rows, 6)[0, 0, detour._COURSE])
            lengths.append(0)
        if away:
            lengths[-1] += 1
        elif lengths and lengths[-1] > 0:
            lengths.append(-1)
    lengths = [n * dt for n in lengths if n > 0]
    assert lengths[:2] == pytest.approx([detour.LASTS, 2 * detour.LASTS], abs=dt)
    first = slow_detour.course(seen, bodies.radius[0, 0], 0, 0)
    second = slow_detour.course(seen, bodies.radius[0, 0], 0, 0, last=first)
    assert courses[:2] == pytest.approx([first, second])


def test_a_crowd_prevents_a_detour_and_ends_one(shown):
    told, views, bodies = shown
    seen, dt = views[3], told[0].dt
    away = seen.neighbours.position - seen.position[:, :, None]
    slots = np.arange(away.shape[2]) < seen.neighbours.count[..., None]
    near = (np.hypot(*np.moveaxis(away, -1, 0)) < detour.AROUND) & slots
    crowded = seen.active & (near.sum(axis=-1) >= detour.CROWD)
    assert crowded.any()
    assert (seen.active & ~crowded).any()

    def steered(mine, count, kind):
        for k in range(count):
            command = np.zeros((*seen.active.shape, 2))
            mine.steer(standing(seen, k * dt, kind), bodies, command)
        return (command != 0.0).any(axis=-1)

    waits = round(1.0 / dt) + 1
    mine = begun(Detours(patience=1.0), told)
    np.testing.assert_array_equal(steered(mine, waits, Kind.AGENT), seen.active & ~crowded)
    mine = begun(Detours(patience=1.0), told)
    assert steered(mine, waits, Kind.DYNAMIC)[crowded].all()
    assert not steered(mine, 1, Kind.AGENT)[crowded].any()


def test_who_gets_on_is_left_alone(shown):
    told, views, bodies = shown
    mine = begun(Detours(patience=1.0), told)
    for k in range(30):
        moved = views[0].position + 0.3 * k
        command = np.full((*views[0].active.shape, 2), 0.125)
        mine.steer(replace(standing(views[0], 0.0), position=moved), bodies, command)
        assert (command == 0.125).all()


def test_the_names_say_what_drives():
    """The paper's method is its policy alone; the hybrids can be it, too."""
    assert make(NAVIGATORS, "recurrent-ppo").required == {Need.RAYS}
    hybrid = make(NAVIGATORS, "recurrent-ppo-vo")
    assert hybrid.required == SENSORS
    assert hybrid.fingerprint == make(NAVIGATORS, "recurrent-ppo").fingerprint
    alone = make(NAVIGATORS, {"type": "recurrent-ppo-vo", "foresight": False, "patience": 0})
    assert alone.required == {Need.RAYS}


@pytest.mark.parametrize("hidden_movers", [False, True])
def test_hidden_movers_are_in_the_encoding_only_if_they_were_in_training(
    shown, hidden_movers, tmp_path, monkeypatch
):
    told, views, _ = shown
    size = encoder("surround").size
    tensors = {"output.weight": np.zeros((size, 2), np.float32),
               "output.bias": np.zeros(2, np.float32)}  # fmt: skip
    about = {"encoder": "surround", "progress": {"decisions": 0, "seconds": 0.0}}
    path = tmp_path / "w.safetensors"
    write_weights(path, tensors, about | {"hidden_movers": hidden_movers})
    pilot = PolicyPilot(path, foresight=True)
    pilot.reset(told, np.arange(len(told)))
    encoded, foreseen = [], []
    encode = pilot._encoder.encode
    monkeypatch.setattr(
        type(pilot._encoder), "encode",
        lambda self, seen, bodies: encoded.append(seen) or encode(seen, bodies),
    )  # fmt: skip
    monkeypatch.setattr(policy_at_work, "without_agents_behind", lambda seen, _: seen)
    monkeypatch.setattr(
        policy_at_work, "foresee", lambda seen, bodies, *rest: foreseen.append(seen) or rest[0]
    )
    for seen in views:
        pilot.twists(seen, np.full(seen.active.shape, 0.5))
    counts = [[seen.neighbours.count.sum() for seen in many] for many in (views, encoded, foreseen)]
    assert counts[2] != counts[0]
    assert counts[1] == counts[2 if hidden_movers else 0]


@pytest.mark.parametrize(("name", "value"), [("ego", True), ("surround", "false")])
def test_weights_that_cannot_have_hidden_movers_are_refused(name, value, tmp_path):
    size, path = encoder(name).size, tmp_path / "w.safetensors"
    tensors = {"output.weight": np.zeros((size, 2), np.float32),
               "output.bias": np.zeros(2, np.float32)}  # fmt: skip
    about = {"encoder": name, "progress": {"decisions": 0, "seconds": 0.0}, "hidden_movers": value}
    write_weights(path, tensors, about)
    with pytest.raises(PluginError, match=f"Got {value!r} with the encoder {name!r} instead"):
        PolicyPilot(path)


def test_included_weights_have_names(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    plus = make(NAVIGATORS, "recurrent-ppo-plus").fingerprint
    for name in ("recurrent-ppo-plus", "recurrent-ppo-plus.safetensors"):
        assert make(NAVIGATORS, {"type": "recurrent-ppo", "weights": name}).fingerprint == plus
    with pytest.raises(PluginError, match=r"mine\.safetensors"):
        make(NAVIGATORS, {"type": "recurrent-ppo", "weights": "mine.safetensors"})
