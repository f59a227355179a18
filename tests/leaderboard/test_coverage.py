"""How often 95 % intervals hold the truth. docs/statistics.md keeps the larger run."""

import numpy as np
import pytest

from tests.leaderboard.coverage import BOUNDED, RATES, covered, covered_rate

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("shape", BOUNDED)
def test_means_of_twenty_worlds(shape):
    share = covered(shape, 20, 400, np.random.default_rng(0))
    assert 0.90 <= share <= 0.99


@pytest.mark.parametrize("case", RATES)
def test_rates_of_twenty_worlds(case):
    share = covered_rate(*case, 20, 400, np.random.default_rng(0))
    assert share >= 0.90
