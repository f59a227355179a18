"""How often ranks and `compare` see a difference, where there is none and where there is.

Smaller than `python -m benchmarks.comparisons`, which docs/statistics.md keeps the output of.
"""

import numpy as np
import pytest

from benchmarks.comparisons import (
    FALSE_ALARMS,
    NULLS,
    PAIRS,
    Design,
    called,
    mean_alarms,
    p_values,
    rate_differences,
    rate_p,
    sign_flips,
    table_alarms,
)
from benchnav.leaderboard import leaderboard
from benchnav.leaderboard.statistics.head_to_head import duel
from studies.simulated_tables import CROWDS, unit_rates, world_rates
from tests.leaderboard.tables import METRICS, scores, table


def test_designs_have_no_difference_in_the_mean_unless_asked():
    for design in NULLS:
        for chance in (0.5, 0.95, 0.99):
            ones, others = np.array(design.chances(chance)).T
            assert ones.mean() == pytest.approx(others.mean())
            assert ones.max() < 1.0
            assert (np.ptp(ones - others) > 0) == bool(design.apart)
        ones, others = np.array(design.chances(0.8, 0.1)).T
        assert ones.mean() - others.mean() == pytest.approx(0.1)


def test_a_family_is_wrong_where_its_first_step_of_holm_is():
    assert called(np.array([0.04] + [0.5] * 19), 1) == pytest.approx(0.05)
    assert called(np.array([0.002] + [0.5] * 19), 20) == pytest.approx(1 - 0.95**20)
    assert called(np.array([0.04] * 20), 20) == 0.0


def test_the_flips_of_before_are_exact_for_few_worlds():
    (p,) = sign_flips([np.full((6, 1), 0.5)])
    assert p == pytest.approx(2**-5, abs=0.006)


@pytest.mark.slow
@pytest.mark.parametrize("chance", [0.5, 0.9, 0.98])
@pytest.mark.parametrize("crowds", PAIRS[2:], ids=lambda crowds: crowds[1].name)
@pytest.mark.parametrize("design", NULLS[1:], ids=lambda design: design.name)
def test_equals_are_seldom_called_different(design, crowds, chance):
    """Alone, and as one of twenty; 10,000 comparisons tell the second to ± 0.02."""
    p = rate_p(design, chance, crowds, 10_000)
    assert called(p, 1) <= FALSE_ALARMS
    assert called(p, 20) <= FALSE_ALARMS + 0.02


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["normal", "log-normal", "SPL: 0 or near 0.9"])
def test_nor_are_means_of_other_quantities(shape):
    for design in (Design(1, 20), Design(5, 20), Design(30, 2)):
        one, many = mean_alarms(shape, design, 20_000)
        assert one <= FALSE_ALARMS
        assert many <= FALSE_ALARMS + 0.02


@pytest.mark.slow
def test_nor_are_the_entries_of_a_table():
    assert table_alarms(10, Design(5, 20), 0.9, CROWDS[2], 500) <= FALSE_ALARMS


@pytest.mark.slow
def test_real_differences_are_found_more_often_than_by_flips_of_all_worlds():
    """As often where scenarios agree, and far more often where they do not."""
    rng = np.random.default_rng(1)
    crowds = (CROWDS[2], CROWDS[2])
    for design, chance, behind, gain in (
        (Design(1, 50), 0.9, 0.12, -0.02), (Design(5, 20), 0.9, 0.08, -0.02),
        (Design(5, 20, 0.3), 0.8, 0.1, 0.1), (Design(5, 20, 0.6), 0.7, 0.1, 0.4),
    ):  # fmt: skip
        parts = rate_differences(design.chances(chance, behind), design.worlds, crowds, 1000, rng)
        now, before = p_values(parts, unit_rates(1000)), sign_flips(parts)
        assert np.mean(now < 0.05) >= np.mean(before < 0.05) + gain


@pytest.mark.slow
def test_the_whole_of_compare_and_of_ranks_is_as_seldom_wrong():
    """Through `duel` and `leaderboard`, with several metrics, scenarios and the mean over them."""
    rng = np.random.default_rng(4)
    compared, ranked = 0, 0
    for _ in range(60):
        rows = []
        for name, chance in (("x@1", 0.98), ("y@1", 0.8), ("z@1", 0.5)):
            for metric in ("success", "collided"):
                one, other = world_rates((chance, chance), CROWDS[2], (30, 1), rng)
                rows += scores({"a": one[:, 0], "b": other[:, 0]}, metric, scenario=name)
        found = duel(table(rows), METRICS, ("success", "collided"), "a", "b").comparisons
        assert len(found) == 8
        compared += any(c.verdict in ("better", "worse") for c in found)
        whole = [r for r in leaderboard(table(rows), METRICS).records if r.scenario == "all"]
        ranked += any(r.rank_low == 2 for r in whole if r.metric == "success")
    assert max(compared, ranked) <= 7  # 0.06 of 60, and two standard errors
