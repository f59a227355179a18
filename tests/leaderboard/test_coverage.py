"""How often 95 % intervals hold the truth.

Smaller than `python -m studies.interval_coverage`, whose output docs/statistics.md keeps:
1,000 tables tell a share of 0.95 to ± 0.014 (two standard errors), by which the limits are wider.
"""

import pytest

from studies.interval_coverage import (
    APART,
    CORRELATIONS,
    cells,
    difference_coverage,
    is_required,
    mean_coverage,
    rate_coverage,
)
from studies.simulated_tables import CROWDS

pytestmark = pytest.mark.slow
TABLES = 1000
LEAST, MOST = 0.93 - 0.014, 0.97 + 0.014
CHANCES = (0.01, 0.05, 0.5, 0.95, 0.98)


def good(chance, share, edge=0.05):
    return share >= LEAST and (share <= MOST or not edge <= chance <= 1 - edge)


@pytest.mark.parametrize("chance", CHANCES)
@pytest.mark.parametrize(("agents", "correlation"), CORRELATIONS)
def test_rates_of_fifty_worlds(chance, agents, correlation):
    share = rate_coverage(chance, TABLES, agents=agents, correlation=correlation, worlds=50)
    assert good(chance, share), share


@pytest.mark.parametrize("chance", CHANCES)
@pytest.mark.parametrize("apart", [0.0, APART])
@pytest.mark.parametrize("crowd", CROWDS[1:4], ids=lambda crowd: crowd.name)
def test_paired_differences_of_fifty_worlds(chance, apart, crowd):
    share = difference_coverage(chance, TABLES, apart=apart, crowd=crowd, worlds=50)
    assert good(chance, share, 0.1), share


@pytest.mark.parametrize("shape", ["normal", "exponential", "SPL: 0 or near 0.9"])
def test_means_of_twenty_worlds(shape):
    assert 0.90 <= mean_coverage(shape, 20, 400) <= 0.99


def test_what_falls_outside_is_measured_again():
    seen = []

    def measure(chance, tables):
        seen.append(tables)
        return 0.92 if tables == 10 and chance == 0.5 else 0.95

    texts = cells(measure, 10)
    assert (seen.count(100), texts[-1]) == (1, "yes")
    assert "0.950*" in texts
    assert cells(lambda chance, tables: 0.92, 10)[-1] == "no"
    assert is_required(0.98, 0.99)
    assert not is_required(0.5, 0.99)
    assert is_required(0.05, 0.99, 0.1)
