import math

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from benchnav.errors import UsageError
from benchnav.leaderboard import Leaderboard, NotApplicable, comparisons, leaderboard
from benchnav.leaderboard.label import require_one_navigator_per_label
from benchnav.leaderboard.metric_faults import faults
from benchnav.leaderboard.record import ALL, ALL_INTERQUARTILE, IGNORANCE
from benchnav.leaderboard.statistics.head_to_head import duel
from tests.leaderboard.tables import METRICS, metric, row, scores, simulated, table

HASH = "navigator_hash"
NAVIGATORS = ("a", "b", "c", "d")


def board(rows, metrics=METRICS, missing=()):
    return leaderboard(table(rows), metrics, missing)


def only(found: Leaderboard, navigator, metric="success", **where):
    chosen = [
        r
        for r in found.records
        if (r.navigator, r.metric) == (navigator, metric)
        and all(getattr(r, k) == v for k, v in where.items())
    ]
    assert len(chosen) == 1, chosen
    return chosen[0]


def graded(*levels, worlds=20):
    """Navigators a, b, … that are right at ``level`` of the worlds, nested."""
    return {
        name: [float(seed < level * worlds) for seed in range(worlds)]
        for name, level in zip(NAVIGATORS, levels, strict=False)
    }


def test_nothing_makes_an_empty_board():
    assert board([]) == Leaderboard((), ())


def test_a_record_says_everything():
    r = only(board(scores(graded(0.9, 0.2))), "a")
    assert (r.scenario, r.track, r.role, r.split) == (
        "leaders/static@1",
        "unknown",
        "leader",
        "test",
    )
    assert (r.scenario_hash, r.horizon, r.dt) == ("c0ffee00", 60.0, 0.1)
    assert (r.unit, r.better, r.episodes, r.defined, r.failures) == ("", "higher", 20, 20, 0)
    assert r.value == pytest.approx(0.9)
    assert 0 < r.low < 0.9 < r.high < 1
    assert (r.rank_low, r.rank_high, r.ranked, r.note) == (1, 1, 2, "")


def test_clear_differences_rank_and_unclear_ones_tie():
    found = board(scores(graded(0.9, 0.85, 0.1)))
    intervals = {n: (only(found, n).rank_low, only(found, n).rank_high) for n in "abc"}
    assert intervals == {"a": (1, 2), "b": (1, 2), "c": (3, 3)}


def test_scenarios_of_other_signs_are_no_noise_to_a_rank():
    """Far apart in three scenarios and reversed in one, with little chance in each."""
    rows = []
    for name, one, other in (("w", 19, 8), ("x", 18, 9), ("y", 20, 8), ("z", 8, 15)):
        values = {"a": [1.0] * one + [0.0] * (20 - one), "b": [1.0] * other + [0.0] * (20 - other)}
        rows += scores(values, scenario=f"{name}@1")
    found = board(rows)
    a, b = only(found, "a", scenario=ALL), only(found, "b", scenario=ALL)
    assert a.low > b.high
    assert (a.rank_high, b.rank_low) == (1, 2)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32))
def test_two_entries_rank_as_the_interval_of_their_difference_says(seed):
    rows = simulated("ab", 3, 6, np.random.default_rng(seed))
    found = board(rows)
    for name in ("success", "spl", "turning"):
        for c in duel(table(rows), METRICS, (name,), "a", "b").comparisons:
            apart = c.low > 0.0 or c.high < 0.0
            assert (only(found, "a", name, scenario=c.scenario).rank_low == 2) == (
                apart and (c.difference > 0) == (METRICS[name].better == "lower")
            )


def test_less_is_better_where_the_metric_says_so():
    found = board(scores(graded(0.9, 0.1), "collided"))
    assert only(found, "b", "collided").rank_low == 1
    assert only(found, "a", "collided").rank_low == 2


@pytest.mark.parametrize(
    "rows", [scores(graded(0.9, 0.2, 0.5)), simulated("abc", 2, 8, np.random.default_rng(1))]
)
@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 2**32))
def test_the_order_of_rows_changes_nothing(rows, seed):
    shuffled = [rows[i] for i in np.random.default_rng(seed).permutation(len(rows))]
    assert repr(board(shuffled)) == repr(board(rows))


def test_rows_that_repeat_an_episode_count_once():
    rows = scores(graded(0.9, 0.2))
    assert repr(board(rows + rows[:7])) == repr(board(rows))


def test_two_values_in_one_world_are_refused():
    with pytest.raises(UsageError, match="'a' has 0 and 1 for 'success' at seed 3"):
        board([*scores(graded(0.9, 0.2)), row("a", 3, "success", 0.0)])


def test_timings_of_repeated_runs_are_averaged():
    name = "latency_p50"
    rows = [row("a", 0, name, 1.0), row("a", 0, name, 3.0), row("a", 1, name, 2.0)]
    assert only(board(rows), "a", name).value == pytest.approx(2.0)


@pytest.mark.parametrize(
    "change",
    [
        {"scenario_hash": "beef"},
        {"horizon": 30.0},
        {"dt": 0.05},
        {"track": "known"},
        {"split": "validation"},
    ],
)
def test_what_differs_in_kind_is_never_ranked_together(change):
    values = graded(0.9, 0.1)
    rows = scores({"a": values["a"]}) + scores({"b": values["b"]}, **change)
    for r in board(rows).records:
        assert r.rank_low is None
        assert (
            r.note in ("no other entry to rank with", "the mean over scenarios ranks")
            or "attempted" in r.note
            or r.track == IGNORANCE.mark
        )


@settings(max_examples=25, deadline=None)
@given(
    st.lists(
        st.tuples(
            st.sampled_from("abcd"), st.sampled_from(["x", "y"]), st.sampled_from([30.0, 60.0])
        ),
        min_size=1,
        max_size=6,
        unique=True,
    )
)
def test_entries_ranked_together_share_hash_horizon_and_worlds(cells):
    rows = [
        r
        for navigator, mark, horizon in cells
        for r in scores({navigator: [1.0, 0.0, 1.0, 0.5]}, scenario_hash=mark, horizon=horizon)
    ]
    for r in board(rows).records:
        if r.ranked and r.scenario != ALL:
            together = sum((m, h) == (r.scenario_hash, r.horizon) for _, m, h in cells)
            assert r.ranked == together


def test_other_coverage_is_flagged_and_not_ranked():
    values = graded(0.9, 0.5, 0.1)
    values["c"][15:] = [None] * 5
    found = board(scores(values))
    assert only(found, "c").note == "attempted 15 worlds and not the same 20 as those that are"
    assert (only(found, "c").rank_low, only(found, "a").ranked) == (None, 2)


def test_a_failed_episode_counts_as_the_worst():
    rows = scores({"a": [1.0, 1.0, 1.0, 1.0]}) + scores({"a": [0.0] * 4}, "collided")
    rows += scores({"a": [0.9] * 4}, "spl") + scores({"a": [0.3] * 4}, "turning")
    rows += scores({"a": [9.0] * 4}, "time_to_goal") + scores({"a": [5.0] * 4}, "path_length")
    for r in rows:
        r["failure"] = "raised ValueError" if r["seed"] == 2 else ""
    found = board(rows)
    assert only(found, "a").value == pytest.approx(0.75)
    assert only(found, "a", "collided").value == pytest.approx(0.25)
    assert only(found, "a", "spl").value == pytest.approx(0.675)
    assert only(found, "a", "turning").defined == 3
    assert only(found, "a", "time_to_goal").defined == 3
    assert only(found, "a", "path_length").defined == 4
    assert {r.failures for r in found.records} == {1}


def test_a_failure_is_not_charged_where_a_world_defines_nothing():
    values = {"a": [0.9, math.nan, 0.8, math.nan], "b": [0.7, math.nan, 0.6, math.nan]}
    rows = scores(values, "spl")
    rows[1]["failure"] = "raised ValueError"
    found = board(rows)
    assert only(found, "a", "spl").value == pytest.approx(0.85)
    assert only(found, "a", "spl").ranked == 2


def test_a_failed_navigator_does_not_rank_where_there_is_no_worst():
    rows = scores({n: [0.1, 0.2, 0.3, 0.4] for n in "abc"}, "turning")
    rows[0]["failure"] = "raised ValueError"
    r = only(board(rows), "a", "turning")
    assert (r.rank_low, r.note) == (None, "undefined in 1 episode in which others have a value")


def test_conditional_metrics_show_their_n_and_never_rank():
    rows = scores({"a": [9.0, math.nan, 7.0], "b": [1.0, 2.0, 3.0]}, "time_to_goal")
    found = board(rows)
    assert only(found, "a", "time_to_goal").defined == 2
    assert {r.note for r in found.records} == {"conditional on arriving"}
    assert {r.rank_low for r in found.records} == {None}


def test_descriptive_and_unknown_metrics_never_rank():
    rows = scores(graded(0.9, 0.1), "path_length") + scores(graded(0.9, 0.1), "novel")
    found = board(rows)
    assert only(found, "a", "path_length").note == "descriptive"
    assert only(found, "a", "novel").note == "the metric's definition is not installed"
    assert {r.rank_low for r in found.records} == {None}


def test_one_world_gives_no_interval_but_a_rate_does():
    rows = [row("a", 0, "turning", 0.4), row("a", 0, "success", 1.0)]
    found = board(rows)
    assert math.isnan(only(found, "a", "turning").low)
    assert only(found, "a", "success").low == pytest.approx(0.05)  # one trial, won


def test_values_that_all_agree_say_what_other_worlds_could_add_or_nothing():
    found = board(scores({"a": [0.0] * 20}, "spl") + scores({"a": [0.5] * 20}, "turning"))
    assert only(found, "a", "spl").low == 0.0
    assert only(found, "a", "spl").high == pytest.approx(1 - 0.025 ** (1 / 20))
    assert math.isnan(only(found, "a", "turning").high)


def test_scenarios_count_alike_in_the_aggregate():
    rows = scores({"a": [1.0] * 10, "b": [0.0] * 10}, scenario="x@1")
    rows += scores({"a": [0.0] * 40, "b": [0.0] * 40}, scenario="y@1")
    r = only(board(rows), "a", scenario=ALL)
    assert r.value == pytest.approx(0.5)
    assert (r.episodes, r.rank_low, r.rank_high) == (50, 1, 1)
    assert math.isnan(r.horizon)


def test_the_interquartile_mean_leaves_the_best_and_the_worst_out():
    rows = [
        r
        for s, level in enumerate((0.0, 0.4, 0.6, 0.9))
        for r in scores(graded(level), scenario=f"s{s}@1")
    ]
    r = only(board(rows), "a", scenario=ALL_INTERQUARTILE)
    assert r.value == pytest.approx(0.5)
    assert r.low < 0.5 < r.high
    assert r.rank_low is None


def test_a_navigator_that_missed_a_scenario_is_not_ranked_over_all():
    rows = scores(graded(0.9, 0.5, 0.1), scenario="x@1") + scores(graded(0.9, 0.5), scenario="y@1")
    missing = [NotApplicable("c", "y@1", "unknown", "needs a map")]
    found = board(rows, missing=missing)
    assert only(found, "c", scenario=ALL).rank_low is None
    absent = only(found, "c", scenario="y@1")
    assert (absent.episodes, absent.note) == (0, "n/a (needs a map)")
    assert math.isnan(absent.value)
    assert only(found, "a", scenario="y@1").ranked == 2


def test_a_cell_that_was_run_after_all_is_not_missing():
    missing = [NotApplicable("a", "leaders/static@1", "unknown", "needs a map")]
    assert only(board(scores(graded(0.9, 0.2)), missing=missing), "a").episodes == 20


@settings(max_examples=25, deadline=None)
@given(st.lists(st.floats(0.3, 1.0), min_size=2, max_size=4), st.integers(0, 2**32))
def test_an_entry_worse_than_all_changes_no_rank_low(chances, seed):
    rng = np.random.default_rng(seed)
    values = {
        name: (2.0 + (rng.random(20) < chance)).tolist()
        for name, chance in zip(NAVIGATORS, chances, strict=False)
    }
    score = {"score": metric("score")}
    before = board(scores(values, "score"), score)
    after = board(scores(values | {"worst": [0.0] * 20}, "score"), score)
    for name in values:
        assert only(after, name, "score").rank_low == only(before, name, "score").rank_low
    assert only(after, "worst", "score").rank_low == len(values) + 1


def test_roles_are_scored_apart():
    rows = scores(graded(0.9, 0.1)) + scores(graded(0.1, 0.9), role="follower")
    found = board(rows)
    assert only(found, "a", role="leader").rank_low == 1
    assert only(found, "a", role="follower").rank_low == 2


def test_a_scenario_more_or_less_leaves_intervals_alone():
    rng = np.random.default_rng(4)
    rows = simulated("ab", 3, 10, rng)
    fewer = board([r for r in rows if r["scenario"] != "leaders/s2@1"])
    for r in board(rows).records:
        if r.scenario in ("leaders/s0@1", "leaders/s1@1"):
            same = only(fewer, r.navigator, r.metric, scenario=r.scenario)
            assert repr(same) == repr(r)


def test_comparisons_pair_the_worlds_of_both():
    rows = scores({"a": [5.0, 7.0, math.nan, 4.0], "b": [4.0, 5.0, 1.0, None]}, "time_to_goal")
    (found,) = comparisons(table(rows), METRICS, "time_to_goal")
    assert (found.first, found.second, found.worlds) == ("a", "b", 2)
    assert found.difference == pytest.approx(1.5)
    assert found.p == pytest.approx(2 * stats.t.sf(3.0, 1))  # mean 1.5, standard error 0.5
    with pytest.raises(UsageError, match="Did you mean 'success'"):
        comparisons(table(rows), METRICS, "succes")


def hashed(rows, *hashes):
    """The table of some rows with the navigator hash of each."""
    whole = table(rows)
    if HASH in whole.column_names:
        whole = whole.drop_columns([HASH])
    return whole.append_column(HASH, pa.array(hashes, pa.string()))


def test_two_navigators_under_one_label_are_never_merged():
    rows = [row("a", 0, "success", 1.0), row("a", 1, "success", 0.0)]
    for reader in (leaderboard, lambda t, m: comparisons(t, m, "success")):
        with pytest.raises(UsageError, match=r"label 'a' must .*aaaa in .* and bbbb in .* label"):
            reader(hashed(rows, "aaaa", "bbbb"), METRICS)


def test_equal_and_unknown_hashes_agree():
    rows = [row("a", 0, "success", 1.0), row("a", 1, "success", 0.0), row("b", 0, "success", 0.0)]
    for hashes in [("aaaa", "", "bbbb"), ("aaaa", "aaaa", "aaaa"), (None, "aaaa", None)]:
        assert only(leaderboard(hashed(rows, *hashes), METRICS), "a").episodes == 2
    without = table(rows)
    if HASH in without.column_names:
        without = without.drop_columns([HASH])
    assert only(leaderboard(without, METRICS), "a").episodes == 2


def test_differently_configured_runs_are_told_by_their_names():
    one, two = (hashed([row("a", 0, "success", 1.0)], h) for h in ("aaaa", "bbbb"))
    with pytest.raises(UsageError, match="aaaa in runs/x and bbbb in runs/y"):
        require_one_navigator_per_label({"runs/x": one, "runs/y": two})


def test_worlds_that_do_not_hold_what_a_metric_needs_are_no_failures():
    def gap(scenario, seed, missing):
        return row("a", seed, "spl", math.nan, scenario=scenario) | {"missing": missing}

    without = [gap("x@1", seed, "n/a: needs people") for seed in range(3)]
    held = [row("a", seed, "spl", 0.5, scenario="y@1") | {"missing": ""} for seed in range(3)]
    raised = [gap("z@1", 0, "ValueError: no"), gap("z@1", 1, "n/a: needs people")]
    rows = without + held + raised
    coded = pa.Table.from_arrays(
        [c.combine_chunks() if pa.types.is_floating(c.type) or pa.types.is_nested(c.type)
         else c.combine_chunks().dictionary_encode() for c in table(rows).columns],
        table(rows).column_names,
    )  # fmt: skip
    assert faults(coded) == faults(table(rows))  # a run is read with dictionaries
    found = board(rows)
    assert only(found, "a", "spl", scenario="x@1").fault == "n/a: needs people"
    assert only(found, "a", "spl", scenario="y@1").fault == ""
    assert only(found, "a", "spl", scenario="z@1").fault == "failed in 1 episode: ValueError: no"
