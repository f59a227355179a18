import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from benchnav.navigation.row_table import RowTable


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 6)), min_size=1, max_size=12))
def test_every_row_gives_what_was_put_last_and_zeros_beside(puts):
    table, held = RowTable(), {}
    for number, (row, agents) in enumerate(puts, start=1):
        value = number + np.arange(agents * 2, dtype=float).reshape(agents, 2)
        table.put(row, place=value)
        held[row] = value
    rows = np.array(list(held))
    for agents in (0, 3, 8):
        taken = table.take("place", rows, agents)
        assert taken.shape == (len(rows), agents, 2)
        for given_row, value in zip(taken, held.values(), strict=True):
            kept = min(agents, len(value))
            np.testing.assert_array_equal(given_row[:kept], value[:kept])
            assert not given_row[kept:].any()


def test_names_are_apart_and_keep_their_types():
    table = RowTable()
    table.put(1, count=np.array([3, 4]), speed=np.array([0.5]))
    assert table.take("count", np.array([1]), 2).tolist() == [[3, 4]]
    assert table.take("count", np.array([1]), 2).dtype == np.int64
    assert table.take("speed", np.array([1]), 1).tolist() == [[0.5]]


def test_what_was_taken_does_not_change_with_the_table():
    table = RowTable()
    table.put(0, speed=np.array([1.0]))
    taken = table.take("speed", np.array([0]), 1)
    table.put(0, speed=np.array([2.0]))
    assert taken.tolist() == [[1.0]]
