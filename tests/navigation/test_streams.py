from dataclasses import replace

import numpy as np

from benchnav.navigation.randomness.agent_streams import agent_streams, canonical_order
from tests.baselines.crowds import briefing, keyed


def told():
    rng = np.random.default_rng(4)
    start = rng.normal(0, 3, (6, 2))
    start[3] = start[1]  # told apart by their goals
    return briefing(start, rng.normal(0, 3, (6, 2)))


def renumbered(one, order):
    return replace(one, start=one.start[order], goal=one.goal[order], rng=keyed(0))


def test_each_agent_keeps_its_stream_when_numbers_change():
    one, order = told(), np.random.default_rng(1).permutation(6)
    plain = [stream.random() for stream in agent_streams(one)]
    other = [stream.random() for stream in agent_streams(renumbered(one, order))]
    assert other == [plain[k] for k in order]
    assert len(set(plain)) == 6


def test_the_order_is_of_places_not_of_numbers():
    one, order = told(), np.random.default_rng(2).permutation(6)
    other = renumbered(one, order)
    np.testing.assert_array_equal(
        one.goal[canonical_order(one)], other.goal[canonical_order(other)]
    )


def test_nobody_has_no_streams():
    assert agent_streams(briefing(np.zeros((0, 2)), np.zeros((0, 2)))) == []
