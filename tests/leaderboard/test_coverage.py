"""How often 95 % intervals hold the truth, and how often `compare` is wrong about equals.

Smaller than `python -m benchmarks.interval_coverage`, whose output docs/statistics.md keeps:
1,000 tables tell a share of 0.95 to ± 0.014 (two standard errors), by which the limits are wider.
"""

import numpy as np
import pytest

from benchmarks.interval_coverage import (
    APART,
    CORRELATIONS,
    CROWDS,
    FALSE_ALARMS,
    Crowd,
    asked,
    cells,
    difference_coverage,
    false_alarms,
    mean_coverage,
    paired_rates,
    rate_coverage,
)
from benchnav.leaderboard.duel import duel
from tests.leaderboard.tables import METRICS, scores, table

pytestmark = pytest.mark.slow
TABLES = 1000
LEAST, MOST = 0.93 - 0.014, 0.97 + 0.014
CHANCES = (0.01, 0.05, 0.5, 0.95, 0.98)


def good(chance, share):
    return share >= LEAST and (share <= MOST or chance in (0.01, 0.98))


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
    assert good(chance, share), share


@pytest.mark.parametrize("shape", ["normal", "exponential", "SPL: 0 or near 0.9"])
def test_means_of_twenty_worlds(shape):
    assert 0.90 <= mean_coverage(shape, 20, 400) <= 0.99


@pytest.mark.parametrize("chance", [0.5, 0.9, 0.98])
@pytest.mark.parametrize("other", [CROWDS[3], Crowd("4 agents, each for itself", 4)])
def test_equals_are_seldom_called_different(chance, other):
    """Twenty comparisons as one family; also where one side's agents alone share their fate.

    400 tables tell 0.06 to ± 0.024.
    """
    wrong = false_alarms(chance, (CROWDS[3], other), 50, 20, 400)
    assert wrong <= FALSE_ALARMS + 0.024


def test_the_whole_of_compare_is_as_seldom_wrong():
    """Through `duel`, with several metrics, scenarios and the mean over them."""
    rng = np.random.default_rng(4)
    wrong = 0
    for _ in range(60):
        rows = []
        for name, chance in (("x@1", 0.98), ("y@1", 0.8), ("z@1", 0.5)):
            for metric in ("success", "collided"):
                one, other = paired_rates((chance, chance), CROWDS[2], (30, 1), rng)
                rows += scores({"a": one[:, 0], "b": other[:, 0]}, metric, scenario=name)
        found = duel(table(rows), METRICS, ("success", "collided"), "a", "b").comparisons
        assert len(found) == 8
        wrong += any(c.verdict in ("better", "worse") for c in found)
    assert wrong <= 7  # 0.06 of 60, and two standard errors


def test_what_falls_outside_is_measured_again():
    seen = []

    def measure(chance, tables):
        seen.append(tables)
        return 0.92 if tables == 10 and chance == 0.5 else 0.95

    texts = cells(measure, 10)
    assert (seen.count(100), texts[-1]) == (1, "yes")
    assert "0.950*" in texts
    assert cells(lambda chance, tables: 0.92, 10)[-1] == "no"
    assert asked(0.98, 0.99)
    assert not asked(0.5, 0.99)
