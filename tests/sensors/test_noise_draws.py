"""Random numbers by a counter: known answers, the slow twin, and their distribution."""

from statistics import NormalDist

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchnav.sensors.noise.draws import draw, normal, threefry, two_normals, uniform
from tests.reference import noise as twin

WORDS = st.integers(0, 2**64 - 1)


@pytest.mark.parametrize(
    ("key", "counter", "answer"),
    [  # kat_vectors of Random123
        ((0, 0), (0, 0), (0xC2B6E3A8C2C69865, 0x6F81ED42F350084D)),
        ((twin.WORD,) * 2, (twin.WORD,) * 2, (0xE02CB7C4D95D277A, 0xD06633D0893B8B68)),
        (
            (0xA4093822299F31D0, 0x082EFA98EC4E6C89),
            (0x243F6A8885A308D3, 0x13198A2E03707344),
            (0x263C7D30BB0F0AF1, 0x56BE8361D3311526),
        ),
    ],
)
def test_known_answers(key, counter, answer):
    assert threefry(*map(np.uint64, (*key, *counter))) == answer == twin.threefry(key, counter)


@given(
    WORDS, WORDS, st.integers(0, 2**32 - 1), st.integers(0, 2**32 - 1), st.integers(0, 6),
    st.integers(-(2**40), 2**40),
)  # fmt: skip
def test_a_draw_is_that_of_the_twin(key_0, key_1, step, agent, channel, index):
    drawn = draw(np.uint64(key_0), np.uint64(key_1), step, agent, channel, index)
    assert drawn == twin.Draws((key_0, key_1), step, agent).words(channel, index)


@given(WORDS)
def test_numbers_of_a_word(word):
    assert uniform(np.uint64(word)) == (word >> 11) / 2**53 < 1.0
    exact = [NormalDist().inv_cdf((half + 0.5) / 2**32) for half in divmod(word, 2**32)]
    np.testing.assert_allclose(two_normals(np.uint64(word)), exact, rtol=1e-6, atol=1e-9)


def test_normal_numbers_are_symmetric_rise_and_keep_their_error_in_the_tails():
    few = np.unique(np.r_[0:40, np.geomspace(40, 2**31 - 1, 3000).astype(int)]).tolist()
    numbers = np.array([normal(k) for k in few])
    exact = [NormalDist().inv_cdf((k + 0.5) / 2**32) for k in few]
    assert np.abs(numbers / exact - 1.0).max() < 1e-6
    assert (np.diff(numbers) > 0.0).all()
    np.testing.assert_array_equal([normal(2**32 - 1 - k) for k in few], -numbers)
    assert normal(0) == pytest.approx(-6.338, abs=1e-3)


def test_neighbouring_counters_are_independent():
    def row(*at):
        first, second = draw(np.uint64(5), np.uint64(7), *at)
        return [*two_normals(np.uint64(first)), *two_normals(np.uint64(second))]

    for which in (0, 1, 3):  # step, agent, index
        at = [3, 2, 1, 4]
        rows = []
        for k in range(3000):
            at[which] = k
            rows.append(row(*at))
        rows = np.array(rows)
        assert np.abs(rows.mean(0)).max() < 0.08
        assert np.abs(rows.std(0) - 1.0).max() < 0.06
        following = np.corrcoef(np.hstack([rows[1:], rows[:-1]]).T)
        assert np.abs(following - np.eye(8)).max() < 0.09
