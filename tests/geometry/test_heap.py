import heapq

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from benchnav.geometry.heap import pop, push


@given(st.lists(st.one_of(st.none(), st.integers(0, 20)), max_size=60))
def test_it_gives_keys_in_the_order_of_the_standard_library(script):
    """A number is pushed, None pops."""
    key, item, count = np.zeros(60), np.zeros(60, np.int64), 0
    twin = []
    for value in script:
        if value is not None:
            count = push(key, item, count, float(value), 7 * value)
            heapq.heappush(twin, value)
        elif twin:
            assert (key[0], item[0]) == (twin[0], 7 * twin[0])
            heapq.heappop(twin)
            count = pop(key, item, count)
        assert count == len(twin)
    rest = []
    while count:
        rest.append(key[0])
        count = pop(key, item, count)
    assert rest == sorted(twin)
