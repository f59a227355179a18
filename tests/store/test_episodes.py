"""What is written is what is read, to the last bit."""

import dataclasses
import json

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from typing_extensions import TypeAliasType, TypeVar

from benchnav.arena.world import ContactRule
from benchnav.store.parts import state_codec
from benchnav.store.parts.digest import digest
from benchnav.store.parts.episodes import LATER, SHAPES, from_table, to_table
from benchnav.store.parts.world_codec import from_json, to_json, world_from_json, world_to_json
from tests.runner.verify.faulty import play
from tests.worlds import random_world

Scalar = TypeVar("Scalar", bound=np.generic)
# What NDArray is since NumPy 2.5, whichever NumPy is installed.
Alias = TypeAliasType("Alias", np.ndarray[tuple[int, ...], np.dtype[Scalar]], type_params=(Scalar,))
Nested = TypeAliasType("Nested", Alias[np.float64])


@dataclasses.dataclass(frozen=True, eq=False)
class Aliased:
    """Arrays under every kind of type hint that stands for one."""

    alias: Alias[np.float64]
    nested: Nested
    plain: np.ndarray
    several: tuple[Alias[np.int64], ...]
    maybe: Alias[np.bool_] | None


@pytest.mark.parametrize("values", [[], [0.5, -np.inf]])
@pytest.mark.parametrize("maybe", [None, np.array([True, False])])
def test_an_array_comes_back_however_its_type_is_written(tools, values, maybe):
    floats = np.array(values)
    several = (np.arange(4).reshape(2, 2), np.array([], dtype=np.int64))
    written = Aliased(floats, floats, floats, several, maybe)
    tools.same(written, from_json(Aliased, to_json(Aliased, written)))


@pytest.mark.parametrize("hint", [list[int], dict, object, np.float64, set[float]])
def test_a_type_that_cannot_be_decoded_is_refused(hint):
    with pytest.raises(TypeError, match="must not hold values of type"):
        from_json(hint, "[1.0]")


@pytest.mark.parametrize("agents", [2, 3])
def test_a_world_comes_back_bit_for_bit(tools, agents):
    world = tools.world(np.random.default_rng(agents), agents)
    back = world_from_json(world_to_json(world).decode())
    tools.same(world, back)
    assert back.agents.max_turn_rate[0] == np.inf


@given(st.lists(st.floats(allow_nan=False) | st.just(np.nan)))
def test_any_float_survives_json(values):
    array = np.array(values, dtype=np.float64)
    kind = np.ndarray[tuple[int], np.dtype[np.float64]]
    text = to_json(kind, array)
    assert repr(json.loads(text)) == repr(["<f8", [len(array)], array.tolist()])
    back = from_json(kind, text)
    assert back.tobytes() == array.tobytes()


@settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    shapes=st.lists(st.tuples(*[st.integers(0, 4)] * 4), min_size=1, max_size=4),
    seed=st.integers(0, 9),
)
def test_episodes_of_any_shape_come_back_bit_for_bit(tools, shapes, seed):
    rng = np.random.default_rng(seed)
    episodes = [
        tools.episode(rng, n, steps, 1 + agents, bodies, events, "act raised" * (n % 2))
        for n, (steps, agents, bodies, events) in enumerate(shapes)
    ]
    back = list(from_table(to_table(episodes)))
    assert len(back) == len(episodes)
    for left, right in zip(episodes, back, strict=True):
        tools.same(left, right)


def test_parts_that_were_written_before_a_column_was_there_are_read(tools, monkeypatch):
    monkeypatch.setattr(state_codec, "can_code", lambda world: False)
    episodes = [tools.episode(np.random.default_rng(n), n) for n in range(3)]
    table = to_table(episodes)
    older = table.drop_columns([name for name in LATER if name in table.column_names])
    for left, right in zip(episodes, from_table(older), strict=True):
        assert (right.timings.latency, right.timings.memory) == (None, None)
        timings = dataclasses.replace(left.timings, latency=None, memory=None)
        identity = dataclasses.replace(left.identity, navigator_hash="")
        tools.same(dataclasses.replace(left, timings=timings, identity=identity), right)


def test_a_digest_tells_states_commands_and_events_apart_and_ignores_timings(tools):
    episode = tools.episode(np.random.default_rng(0))
    same = dataclasses.replace(episode, timings=dataclasses.replace(episode.timings, planning=9.0))
    assert digest(same) == episode.digest
    for name in ("position", "heading", "requested", "executed", "body_position", "arrival"):
        changed = getattr(episode, name).copy()
        changed.flat[-1] = np.nextafter(changed.flat[-1], np.inf)
        assert digest(dataclasses.replace(episode, **{name: changed})) != episode.digest, name
    contacts = dataclasses.replace(episode.contacts, charged=~episode.contacts.charged)
    assert digest(dataclasses.replace(episode, contacts=contacts)) != episode.digest


def test_the_digest_never_changes_its_meaning(tools):
    """A stored digest must mean the same for ever: this one was computed when schema 1 was made."""
    episode = tools.episode(np.random.default_rng(0))
    fixed = dataclasses.replace(
        episode,
        position=np.arange(36.0).reshape(6, 3, 2), heading=np.zeros((6, 3)),
        status=np.zeros((6, 3), np.int8), requested=np.ones((5, 3, 2)),
        executed=np.ones((5, 3, 2)), body_position=np.zeros((6, 2, 2)), arrival=np.ones(3),
        contacts=dataclasses.replace(
            episode.contacts,
            **{
                f.name: np.zeros(2, getattr(episode.contacts, f.name).dtype)
                for f in dataclasses.fields(episode.contacts)
            },
        ),
    )  # fmt: skip
    assert digest(fixed) == "7a58b35d18ab4f6f10c7704f283e143faa7c64fddb96a8eab80c9cd11236cbc5"


@pytest.mark.parametrize("contact", list(ContactRule))
@pytest.mark.parametrize("unicycle", [False, True])
@pytest.mark.parametrize("twist", [False, True])
def test_states_of_a_simulation_are_stored_as_zeros_where_nothing_happens(contact, unicycle, twist):
    world = random_world(3, contact=contact, unicycle=unicycle, steps=60)
    episode = play(world, 3)
    if twist:
        episode = dataclasses.replace(episode, twist=np.ones(len(world.agents), np.bool_))
    states = {name: getattr(episode, name) for name in SHAPES}
    turns = np.zeros(len(world.agents), np.bool_) if episode.twist is None else episode.twist
    coded = state_codec.coded(world, turns, states)
    back = state_codec.decoded(world, turns, {**states, **coded})
    assert back.keys() == {*state_codec.CODED, state_codec.BODIES}
    for name, array in back.items():
        assert array.tobytes() == states[name].tobytes()
    if not twist:
        for name, array in coded.items():
            assert (array.view(np.int64) == 0).mean() > 0.2, name  # agents touch all the time


def test_coded_states_of_a_strange_world_are_refused(tools):
    episode = tools.episode(np.random.default_rng(0))
    world, twist = episode.world, np.zeros(len(episode.world.agents), np.bool_)
    states = {name: getattr(episode, name) for name in SHAPES}
    bad = [
        dataclasses.replace(world, clock=dataclasses.replace(world.clock, substeps=10**9)),
        dataclasses.replace(
            world, agents=dataclasses.replace(world.agents, start=world.agents.start[:, :1])
        ),
        dataclasses.replace(
            world,
            bodies=tuple(
                dataclasses.replace(b, law=dataclasses.replace(b.law, points=np.zeros((0, 2))))
                for b in world.bodies
            ),
        ),
    ]
    for strange in bad:
        with pytest.raises(ValueError, match=r"substeps|reshape|points"):
            state_codec.decoded(strange, twist, states)
    with pytest.raises(ValueError, match="reshape"):
        state_codec.decoded(world, twist[:1], states)
