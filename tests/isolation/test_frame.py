"""Frames keep what they are given, and refuse what is none."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from benchnav.isolation.frame import HEAD, MAX_SIZE, decode, encode, head

NAMES = st.text("abcdefghijklmnopqrstuvwxyz._", min_size=1, max_size=24)
ARRAYS = st.sampled_from(["<f8", "<i8", "i1", "u1", "?"]).flatmap(
    lambda dtype: arrays.arrays(dtype, arrays.array_shapes(min_dims=1, max_dims=4, min_side=0))
)
VALUES = ARRAYS | st.text() | st.floats(allow_nan=False) | st.integers(-(2**63), 2**63 - 1)


def unpacked(frame):
    kind, count, size = head(frame)
    assert len(frame) == HEAD.size + size
    return kind, decode(count, bytearray(frame[HEAD.size :]))


@given(st.dictionaries(NAMES, VALUES, max_size=5))
def test_what_is_put_in_comes_out(fields):
    kind, got = unpacked(encode("act", fields))
    assert (kind, list(got)) == ("act", list(fields))
    for name, value in fields.items():
        if isinstance(value, np.ndarray):
            assert got[name].dtype == value.dtype
            assert got[name].shape == value.shape
            assert got[name].tobytes() == value.tobytes()
        else:
            assert got[name] == value


def test_fields_begin_at_multiples_of_eight_and_can_be_written():
    frame = encode("x", {"text": "é", "flags": np.ones(3, bool), "numbers": np.arange(2.0)})
    assert len(frame) % 8 == 0
    _, got = unpacked(frame)
    got["numbers"][0] = 7.0
    assert got["numbers"].tolist() == [7.0, 1.0]


@given(st.binary(min_size=HEAD.size, max_size=200))
def test_garbage_is_refused_and_does_nothing_else(data):
    try:
        _, count, size = head(data)
        assert size <= MAX_SIZE
        decode(count, bytearray(data[HEAD.size :]))
    except ValueError:  # UnicodeDecodeError is one
        pass


@pytest.mark.parametrize(
    "change",
    [
        lambda f: f[:-8],  # cut
        lambda f: f[: HEAD.size + 24] + b"z" + f[HEAD.size + 25 :],  # no such type
        lambda f: f[: HEAD.size + 25] + b"\x09" + f[HEAD.size + 26 :],  # nine axes
        lambda f: f[: HEAD.size + 32] + b"\xff" * 8 + f[HEAD.size + 40 :],  # longer than all
    ],
)
def test_a_damaged_field_is_refused(change):
    frame = change(encode("act", {"rows": np.arange(4)}))
    with pytest.raises(ValueError, match=r"field|frame"):
        decode(1, bytearray(frame[HEAD.size :]))


def test_a_printed_line_is_no_frame():
    with pytest.raises(ValueError, match="no frame begins with b'hello"):
        head(b"hello, I am a navigator\n and more")


def test_names_have_their_limit():
    with pytest.raises(ValueError, match="24 letters"):
        encode("act", {"n" * 25: 1.0})
