"""A navigator's randomness is fixed by its world, and tells nothing about it."""

import itertools

from benchnav.runner.generators import generator

WORLDS = list(itertools.product(["a" * 16, "b" * 16], ["train", "test"], range(20), range(3)))


def test_the_same_world_gives_the_same_stream():
    first, again = (generator("a" * 16, "test", 3, 0).random(5) for _ in range(2))
    assert first.tolist() == again.tolist()


def test_every_scenario_split_seed_and_driver_has_a_stream_of_its_own():
    assert len({generator(*world).random() for world in WORLDS}) == len(WORLDS)


def test_nothing_in_the_generator_is_the_seed():
    seeded = generator("a" * 16, "test", 7, 0).bit_generator.seed_seq
    assert seeded.entropy > 2**128
    assert seeded.spawn_key == ()


def test_the_stream_never_changes():
    assert generator("0" * 16, "test", 0, 0).integers(0, 2**32) == 2818593399
