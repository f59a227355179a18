"""A navigator's randomness is fixed by its world and run, and tells nothing about them."""

import itertools
import pickle

import numpy as np
import pytest

from benchnav.runner.rollouts.seeding import check_salt, draw_salt, generator, place

WORLDS = list(itertools.product(["a" * 16, "b" * 16], ["train", "test"], range(20), range(3)))
SALT = "5a" * 16


def test_the_same_world_gives_the_same_stream():
    first, again = (generator(SALT, "a" * 16, "test", 3, 0).random(5) for _ in range(2))
    assert first.tolist() == again.tolist()


def test_every_scenario_split_seed_and_driver_has_a_stream_of_its_own():
    assert len({generator(SALT, *world).random() for world in WORLDS}) == len(WORLDS)


def test_who_does_not_know_the_salt_cannot_find_the_world_by_trying():
    """All worlds of two runs: no stream of one is in the other."""
    states = [
        {generator(salt, *world).bit_generator.state["state"]["state"] for world in WORLDS}
        for salt in (draw_salt(), draw_salt())
    ]
    assert len(states[0] | states[1]) == 2 * len(WORLDS)


def test_no_seed_sequence_can_be_recovered():
    rng = generator(SALT, "a" * 16, "test", 7, 0)
    held = rng.bit_generator.seed_seq
    assert not hasattr(held, "entropy")
    assert not hasattr(held, "spawn_key")
    whole = pickle.dumps(rng)
    assert b"a" * 16 not in whole
    assert SALT.encode() not in whole
    assert bytes.fromhex(SALT) not in whole


def test_spawned_streams_are_all_different_and_the_same_each_time():
    def children():
        rng = generator(SALT, "a", "test", 0, 0)
        return [r.random() for r in (rng, *rng.spawn(3), *rng.spawn(2), *rng.spawn(1)[0].spawn(2))]

    assert len(set(children())) == 8
    assert children() == children()


def test_a_copied_generator_goes_on_as_the_first_would():
    rng = generator(SALT, "a", "test", 0, 0)
    rng.random(3)
    copy = pickle.loads(pickle.dumps(rng))
    assert copy.random() == rng.random()


@pytest.mark.parametrize("dtype", [np.uint32, np.uint64])
def test_state_words_fill_their_type(dtype):
    words = generator(SALT, "a", "test", 0, 0).bit_generator.seed_seq.generate_state(64, dtype)
    assert words.dtype == dtype
    assert words.max() > np.iinfo(dtype).max // 2


def test_the_order_of_worlds_follows_the_salt():
    orders = {
        tuple(sorted(range(9), key=lambda seed: place(salt, "a", "test", seed)))
        for salt in ("00", "01", "02")
    }
    assert len(orders) == 3


def test_a_drawn_salt_is_one_and_never_the_same():
    drawn = {draw_salt() for _ in range(20)}
    assert len(drawn) == 20
    for salt in drawn:
        check_salt(salt)


def test_the_stream_never_changes():
    assert generator(SALT, "0" * 16, "test", 0, 0).integers(0, 2**32) == 3905808441
