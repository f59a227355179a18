"""Every two navigators compared together: the same numbers as each pair alone."""

from dataclasses import asdict
from itertools import combinations

import numpy as np
import pytest

from benchnav.errors import UsageError
from benchnav.leaderboard.record import NotApplicable
from benchnav.leaderboard.statistics.all_pairs import duels
from benchnav.leaderboard.statistics.head_to_head import duel
from tests.leaderboard.tables import METRICS, scores, simulated, table

NAMES = ("success", "collided", "spl", "time_to_goal")
TRACKS = ("known", "unknown")


def _check(rows, gaps=()):
    """Compare each pair with `duel`; return the pairs without a common world."""
    results = table(rows)
    navigators = sorted({row["navigator"] for row in rows})
    found = list(duels(results, METRICS, NAMES, gaps))
    assert [(d.first, d.second) for d in found] == list(combinations(navigators, 2))
    apart = []
    for each in found:
        try:
            alone = duel(results, METRICS, NAMES, each.first, each.second, gaps)
        except UsageError:
            assert not each.comparisons
            apart.append((each.first, each.second))
            continue
        assert each.notes == alone.notes
        assert len(each.comparisons) == len(alone.comparisons)
        for mine, its in zip(each.comparisons, alone.comparisons, strict=True):
            _equal(asdict(mine), asdict(its))
    return apart


def _equal(one, other):
    """Whether two comparisons are equal, except for the rounding of sums."""
    numbers = [name for name, value in other.items() if isinstance(value, float)]
    for name in numbers:
        assert one.pop(name) == pytest.approx(other.pop(name), rel=1e-9, abs=1e-12, nan_ok=True)
    assert one == other


def _simulated(**options):
    rng = np.random.default_rng(7)
    return simulated(["a", "b", "c", "d"], 3, 8, rng, **options)


def test_each_pair_has_the_numbers_of_a_comparison_alone():
    assert _check(_simulated(tracks=TRACKS)) == []


def test_navigators_that_miss_scenarios_tracks_or_seeds():
    rows = [
        r
        for r in _simulated(tracks=TRACKS)
        if not (r["navigator"] == "b" and r["track"] == "unknown")
        and not (r["navigator"] == "c" and r["scenario"] == "leaders/s1@1")
        and not (r["navigator"] == "d" and (r["seed"] > 4 or r["scenario"] != "leaders/s2@1"))
    ]
    gaps = [NotApplicable("b", f"leaders/s{s}@1", "unknown", "needs a map") for s in range(3)]
    assert _check(rows, gaps) == []


def test_failures_of_one_and_of_both():
    rows = _simulated()
    for r in rows:
        if r["navigator"] in ("a", "b") and r["seed"] < 2:
            r["failure"] = "ValueError"
            r["value"] = float("nan") if r["metric"] == "time_to_goal" else r["value"]
    assert _check(rows) == []


def test_different_rehearsals_have_no_verdict():
    rows = [r | {"rehearsal": 5 * (r["navigator"] == "a")} for r in _simulated()]
    assert _check(rows) == []


def test_metrics_that_not_all_navigators_have():
    rows = [r for r in _simulated() if not (r["navigator"] == "a" and r["metric"] == "spl")]
    assert _check(rows) == []


def test_navigators_without_a_common_world_have_no_comparison():
    rows = [
        *scores({"a": [1, 0], "b": [1, 1]}),
        *scores({"c": [1, 0]}, scenario="leaders/other@1"),
    ]
    assert _check(rows) == [("a", "c"), ("b", "c")]


def test_the_order_of_two_navigators_only_changes_signs():
    results = table(_simulated())
    one, other = (duel(results, METRICS, NAMES, *pair).comparisons for pair in ("ab", "ba"))
    mirrored = {"better": "worse", "worse": "better", "higher": "lower", "lower": "higher"}
    for mine, its in zip(one, other, strict=True):
        assert mine.difference == pytest.approx(-its.difference, nan_ok=True)
        assert (mine.low, mine.high) == pytest.approx((-its.high, -its.low), nan_ok=True)
        assert mine.verdict == mirrored.get(its.verdict, its.verdict)
