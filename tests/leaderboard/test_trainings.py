"""Entries with several trainings: their mean, their spread, and differences over trainings."""

import csv
import io
import math
from dataclasses import asdict
from itertools import combinations

import numpy as np
import pytest
from scipy.stats import t

from benchnav.errors import UsageError
from benchnav.leaderboard import leaderboard
from benchnav.leaderboard.rendering.formats import render
from benchnav.leaderboard.rendering.prose import render_duel
from benchnav.leaderboard.statistics.all_pairs import duels
from benchnav.leaderboard.statistics.head_to_head import duel
from benchnav.leaderboard.statistics.over_trainings import half_width
from benchnav.leaderboard.statistics.trainings import Spread
from benchnav.navigation.plugin.trainings import Training
from tests.leaderboard.tables import METRICS, scores, simulated, table

THREE = [Training("net", k, 3).label for k in (1, 2, 3)]
RNG = np.random.default_rng(5)
VALUES = {name: RNG.integers(0, 5, 20) / 4 for name in (*THREE, "orca")}
ROWS = scores(VALUES) + scores({n: v[::-1] for n, v in VALUES.items()}, scenario="leaders/b@1")


def record(rows, navigator="net", scenario="leaders/static@1", metric="success"):
    (found,) = [
        r for r in leaderboard(table(rows), METRICS).records
        if (r.navigator, r.scenario, r.metric) == (navigator, scenario, metric)
    ]  # fmt: skip
    return found


def test_a_value_is_the_mean_and_the_spread_is_that_of_the_means():
    assert leaderboard(table(ROWS), METRICS).navigators == ("net", "orca")
    means = [VALUES[name].mean() for name in THREE]
    for scenario in ("leaders/static@1", "all"):
        found = record(ROWS, scenario=scenario)
        assert found.value == pytest.approx(np.mean(means))
        assert found.trainings == 3
        assert (found.training_least, found.training_most) == pytest.approx(
            (min(means), max(means))
        )
        assert found.training_deviation == pytest.approx(np.std(means, ddof=1))
        assert found.low < found.value < found.high
    assert record(ROWS).episodes == 20
    assert math.isnan(record(ROWS, "orca").training_least)


def test_more_trainings_of_agents_that_act_for_themselves_narrow_the_interval():
    """Their agents are more agents of the same worlds."""
    rng = np.random.default_rng(0)
    values = {name: rng.binomial(4, 0.5, 100) / 4 for name in THREE}
    alone = record(scores({"net": values[THREE[0]]}))
    pooled = record(scores(values))
    assert pooled.high - pooled.low == pytest.approx(
        (alone.high - alone.low) / math.sqrt(3), rel=0.2
    )


def test_a_world_counts_if_all_trainings_attempted_it():
    whole, partial = [1.0, 0.5, 0.0, 0.5], [1.0, 0.5, None, 0.5]
    values = {THREE[0]: whole, THREE[1]: partial, THREE[2]: whole}
    found = record(scores(values))
    assert found.episodes == 3
    assert found.value == pytest.approx(2 / 3)


def test_a_failure_of_a_training_counts_and_conditional_values_are_means_of_the_defined():
    rows = scores({name: [1.0, 1.0] for name in THREE})
    rows[0] |= {"failure": "it broke", "value": 0.0}
    assert record(rows).failures == 1
    assert record(rows).value == pytest.approx(5 / 6)
    times = {THREE[0]: [8.0, math.nan], THREE[1]: [6.0, math.nan], THREE[2]: [math.nan, math.nan]}
    found = record(scores(times, "time_to_goal"), metric="time_to_goal")
    assert (found.value, found.defined) == (7.0, 1)


def test_a_label_that_is_also_an_entry_is_refused():
    with pytest.raises(
        UsageError, match="It stands for one training and for an entry with several"
    ):
        leaderboard(table([*ROWS, *scores({"net": [1.0]})]), METRICS)


def test_tables_show_the_trainings_only_if_there_are_several():
    several, single = (
        leaderboard(table(rows), METRICS) for rows in (ROWS, scores({"a": [1.0, 0.0]}))
    )
    text = render(several, "markdown")
    assert "| trainings " in text
    assert "trainings: the least and the most successful of (n) trainings" in text
    least, most = sorted(VALUES[name].mean() for name in THREE)[::2]
    assert f"| {least:.2f}–{most:.2f} (3) " in text
    assert "trainings" not in render(single, "markdown")
    for board, columns in ((several, 4), (single, 0)):
        heads = next(csv.reader(io.StringIO(render(board, "csv"))))
        assert (
            sum(name == "trainings" or name.startswith("training_") for name in heads)
            == columns + 2
        )


def test_a_difference_over_trainings_has_the_width_of_its_formula():
    found = duel(table(ROWS), METRICS, ["success"], "net", "orca")
    whole = found.comparisons[-1]
    means = [VALUES[name].mean() for name in THREE]
    apart = t.ppf(0.975, 2) * np.std(means, ddof=1) / math.sqrt(3)
    assert whole.training_low == pytest.approx(
        whole.difference - math.hypot(whole.difference - whole.low, apart)
    )
    assert whole.training_high == pytest.approx(
        whole.difference + math.hypot(whole.high - whole.difference, apart)
    )
    text = render_duel(found, METRICS)
    assert "other trainings: " in text or "Other trainings may reverse it: " in text
    two = 100 * t.ppf(0.975, 2) * math.sqrt(2) * np.std(means, ddof=1)
    assert f"two trainings of net differ by up to {float(f'{two:.2g}'):g} points (95 %; " in text


def test_trainings_vary_by_what_is_known_of_them():
    one, three = Spread(), Spread(3, 0.1, 0.5, 0.2)
    five = Spread(5, 0.1, 0.5, 0.1)
    assert half_width([three, one], [True, False]) == pytest.approx(
        t.ppf(0.975, 2) * 0.2 / math.sqrt(3)
    )
    assert half_width([one, three], [True, True]) == pytest.approx(
        t.ppf(0.975, 2) * 0.2 * math.sqrt(4 / 3)
    )
    parts = 0.04 / 3, 0.01 / 5
    freedom = sum(parts) ** 2 / (parts[0] ** 2 / 2 + parts[1] ** 2 / 4)
    assert half_width([three, five], [True, True]) == pytest.approx(
        t.ppf(0.975, freedom) * math.sqrt(sum(parts))
    )
    assert half_width([Spread(3, 0.5, 0.5, 0.0), one], [True, False]) == 0.0


def test_the_interval_over_trainings_contains_the_difference_of_recipes():
    """Two recipes of equal expected success, whose trainings vary more than their worlds."""
    rng = np.random.default_rng(1)
    over_worlds = over_trainings = 0
    for _ in range(200):
        skills = rng.normal(0.5, 0.1, 6)
        names = [Training(name, k, 3).label for name in "ab" for k in (1, 2, 3)]
        rows = scores({
            n: np.clip(rng.normal(s, 0.1, 30), 0, 1) for n, s in zip(names, skills, strict=True)
        }, "spl")  # fmt: skip
        (c,) = duel(table(rows), METRICS, ["spl"], "a", "b").comparisons
        over_worlds += c.low < 0.0 < c.high
        over_trainings += c.training_low < 0.0 < c.training_high
    assert over_trainings > 185 > 120 > over_worlds


def test_one_training_can_be_compared_with_another_and_not_with_its_own_entry():
    found = duel(table(ROWS), METRICS, ["success"], THREE[0], THREE[2])
    assert found.comparisons[0].difference == pytest.approx(
        VALUES[THREE[0]].mean() - VALUES[THREE[2]].mean()
    )
    assert math.isnan(found.comparisons[0].training_low)
    with pytest.raises(UsageError, match="one of which includes the other"):
        duel(table(ROWS), METRICS, ["success"], "net", THREE[0])


def test_every_pair_has_the_numbers_of_its_comparison_alone():
    names = [*THREE[:2], "b", "c"]
    results = table(simulated(names, 2, 8, np.random.default_rng(3)))
    found = list(duels(results, METRICS, ("success", "spl"), trained=["b"]))
    assert [(d.first, d.second) for d in found] == list(combinations(["b", "c", "net"], 2))
    for each in found:
        alone = duel(results, METRICS, ("success", "spl"), each.first, each.second, trained=["b"])
        for mine, its in zip(each.comparisons, alone.comparisons, strict=True):
            assert asdict(mine) == pytest.approx(asdict(its), nan_ok=True)
