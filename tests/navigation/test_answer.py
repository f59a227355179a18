"""A command is finite, of the right shape, and made of numbers; everything else is refused."""

import numpy as np
import pytest

from benchnav.navigation.command_check import MOST_REMARKS, CallFailed, checked, remarks_of

ACTIVE = np.array([[True, True], [True, False]])


@pytest.mark.parametrize("dtype", [np.float64, np.float32, np.int64])
def test_real_numbers_of_any_width_are_commands(dtype):
    told = checked(np.ones((2, 2, 2), dtype), ACTIVE)
    assert told.dtype == np.float64
    assert told[0, 0].tolist() == [1.0, 1.0]


def test_what_is_said_for_the_inactive_is_ignored_even_if_it_is_nothing():
    answer = np.ones((2, 2, 2))
    answer[1, 1] = np.nan
    assert checked(answer, ACTIVE)[1, 1].tolist() == [0.0, 0.0]


def test_a_command_that_is_not_finite_names_its_world():
    answer = np.ones((2, 2, 2))
    answer[1, 0, 1] = np.inf
    with pytest.raises(CallFailed, match=r"finite numbers. Got \(1, inf\) for agent 0") as failed:
        checked(answer, ACTIVE)
    assert failed.value.suspects.tolist() == [1]


@pytest.mark.parametrize(
    ("answer", "got"),
    [
        (None, "Got None"),
        ("north", "Got a str"),
        (np.ones((2, 2)), r"of shape \(2, 2, 2\). Got shape \(2, 2\)"),
        (np.ones((2, 2, 3)), r"Got shape \(2, 2, 3\)"),
        (np.ones((2, 2, 2), complex), "Got dtype complex128"),
        (np.ones((2, 2, 2), bool), "Got dtype bool"),
        (np.full((2, 2, 2), None), "Got dtype object"),
        ([[1], [1, 2]], "must return an array. Got a list"),
        ({"v": 1}, "Got a dict"),
    ],
)
def test_what_is_no_command_is_refused_by_what_it_is(answer, got):
    with pytest.raises(CallFailed, match=got) as failed:
        checked(answer, ACTIVE)
    assert failed.value.suspects is None


def test_remarks_are_texts_however_they_are_answered():
    assert remarks_of(None) == []
    assert remarks_of("one sentence") == ["one sentence"]
    assert remarks_of(["a\nb", 3]) == ["a b", "3"]
    assert len(remarks_of(str(k) for k in range(10**9))) == MOST_REMARKS
