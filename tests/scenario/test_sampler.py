import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter

from benchnav.scenario.sampling.sampler import (
    Choice,
    Integers,
    Normal,
    Scalar,
    Uniform,
    fixed,
    sample,
    support,
)

_NUMBER = st.floats(-1e3, 1e3)


@st.composite
def samplers(draw):
    low, high = sorted([draw(_NUMBER), draw(_NUMBER)])
    kind = draw(st.sampled_from(["number", "uniform", "normal", "choice", "integers"]))
    if kind == "number":
        return low
    if kind == "uniform":
        return Uniform(uniform=(low, high))
    if kind == "normal":
        mean = low + (high - low) * draw(st.floats(0, 1))
        mean = min(max(mean, low), high)
        return Normal(normal=(mean, draw(st.floats(0, 100)), low, high))
    if kind == "choice":
        return Choice(choice=tuple(draw(st.lists(_NUMBER, min_size=1, max_size=5))))
    return Integers(integers=(int(np.floor(low)), int(np.floor(high))))


@given(samplers(), st.integers(0, 2**32))
def test_draws_lie_in_the_support_and_repeat(scalar, seed):
    low, high = support(scalar)
    draws = [sample(scalar, np.random.default_rng(seed)) for _ in range(2)]
    assert draws[0] == draws[1]
    assert low <= draws[0] <= high
    if fixed(scalar):
        assert draws[0] == low


@given(samplers())
def test_what_is_written_is_read(scalar):
    adapter = TypeAdapter(Scalar)
    assert adapter.validate_json(adapter.dump_json(scalar)) == scalar


def test_integers_reach_both_ends_and_choices_all():
    rng = np.random.default_rng(1)
    assert {sample(Integers(integers=(2, 4)), rng) for _ in range(100)} == {2.0, 3.0, 4.0}
    assert {sample(Choice(choice=(1.0, 5.0)), rng) for _ in range(100)} == {1.0, 5.0}


def test_normal_has_its_mean_and_spread():
    rng = np.random.default_rng(2)
    draws = [sample(Normal(normal=(1.0, 0.2, -9.0, 9.0)), rng) for _ in range(4000)]
    assert np.mean(draws) == pytest.approx(1.0, abs=0.02)
    assert np.std(draws) == pytest.approx(0.2, abs=0.02)


def test_a_number_draws_nothing():
    rng = np.random.default_rng(3)
    sample(2.0, rng)
    assert rng.random() == np.random.default_rng(3).random()
