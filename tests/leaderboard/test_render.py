import csv
import html.parser
import io
import json
import math
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchnav.errors import UsageError
from benchnav.leaderboard import Leaderboard, NotApplicable, leaderboard, render
from benchnav.leaderboard.columns import choose
from benchnav.leaderboard.rendering import escape
from benchnav.leaderboard.rendering.digits import number
from tests.leaderboard.tables import METRICS, metric, row, scores, simulated, table

FORMATS = ("markdown", "csv", "latex", "html", "json")
TIDY = ("navigator", "scenario", "track", "role", "metric", "value", "low", "high", "unit",
        "better", "episodes", "rank_low", "rank_high")  # fmt: skip
NASTY = (
    "=cmd|' /C calc'!A0", "<script>alert(1)</script>", "| a | b |", "**bold** `code` [x](y)",
    "\\input{/etc/passwd} $x_1$ 50% #1 & ~^{}", '"><img src=x onerror=alert(1)>', "a\nb\r\n- c",
    "\x1b[31mred\x1b[0m", "\u202eright to left", "_emphasis_", "@SUM(1)", "-1+1", "+1", "\t=1",
    "![image](http://x)", "<!-- ", "&lt;", "[x]: http://y",
)  # fmt: skip


@pytest.fixture(scope="module")
def board():
    rows = simulated(["alpha", "beta", "gamma"], 4, 12, np.random.default_rng(2))
    missing = [NotApplicable("mapper", "leaders/s0@1", "unknown", "needs a map")]
    return leaderboard(table(rows), METRICS, missing)


def named(name):
    return leaderboard(table(scores({name: [1.0, 0.0, 1.0], "plain": [1.0] * 3})), METRICS)


def test_markdown_reads_well():
    rows = scores({"good": [1.0] * 19 + [0.0], "bad": [0.0] * 20})
    rows += scores(
        {"good": [math.nan, *[3.25] * 10, *[4.75] * 9], "bad": [math.nan] * 20}, "time_to_goal"
    )
    rows[19]["failure"] = "raised ValueError"
    text = render(leaderboard(table(rows), METRICS), "markdown")
    assert text.startswith(
        "## Track unknown\n\n### leaders/static@1, track unknown, leaders, 20 worlds\n"
        "\n"
        "| navigator      | rank | success ↑                | time_to_goal ↓        |\n"
        "| -------------- | ---- | ------------------------ | --------------------- |\n"
        "| good, 1 failed | 1    | **0.950 [0.777, 0.997]** | 3.9 [3.6, 4.3] s (18) |\n"
        "| bad            | 2    | 0 [0, 0.14]              | –                     |\n"
        "\n"
        "good failed in 1 of 20 worlds: raised ValueError.  \n"
        "\n"
        "value [low, high]: mean"
    )


def test_default_tables_fit_a_wide_terminal(board):
    assert max(map(len, render(board, "markdown").splitlines())) <= 140


def test_unranked_entries_come_last_with_their_reason(board):
    table = re.search(r"### leaders/s0@1.*\n\n((?:\|.*\n)+)", render(board, "markdown"))
    first = table[1].splitlines()
    assert re.match(r"\| mapper +\| – +\| n/a \(needs a map\) +\|", first[-1])


@pytest.mark.parametrize("format", ["markdown", "latex", "html"])
def test_nothing_is_bold_where_all_tie_and_the_legend_says_so(format):
    marks = {"markdown": "**", "latex": "textbf{", "html": "<strong>"}
    tied = leaderboard(table(scores({"a": [1.0, 0.0], "b": [0.0, 1.0]})), METRICS)
    text = render(tied, format)
    assert marks[format] not in text
    assert "Bold: not significantly worse than any other entry; nothing is bold where all" in text
    one = leaderboard(table(scores({"a": [1.0] * 20, "b": [0.0] * 20})), METRICS)
    assert render(one, format).count(marks[format]) == (2 if format == "markdown" else 1)


def test_the_legend_says_what_a_rank_means(board):
    text = " ".join(render(board, "markdown").split())
    assert "Scenarios are fixed: a rank holds for other seeds of these." in text
    assert "the paired 95 % interval over the worlds excludes 0, after Holm" in text


def test_many_metrics_stand_below_each_other():
    rows = [row(n, s, f"m{k}", float(s)) for n in "abcdefg" for s in range(3) for k in range(9)]
    text = render(leaderboard(table(rows), METRICS), "markdown", ["all"])
    assert "| metric    | a " in text
    assert text.count("| m8 ") == 2  # five navigators abreast, then two


def test_variants_of_a_scenario_say_what_differs():
    rows = scores({"a": [1.0, 0.0]}) + scores({"b": [1.0, 0.0]}, horizon=30.0)
    text = render(leaderboard(table(rows), METRICS), "markdown")
    assert "horizon 30 s, dt 0.1 s, hash c0ffee00" in text
    assert "horizon 60 s, dt 0.1 s, hash c0ffee00" in text


def test_another_split_is_named():
    text = render(leaderboard(table(scores({"a": [1.0]}, split="validation")), METRICS), "markdown")
    assert "split validation" in text


def test_other_coverage_is_explained_below_the_table():
    rows = scores({"a": [1.0, 0.0], "b": [1.0, 0.0], "c": [1.0, None]})
    text = render(leaderboard(table(rows), METRICS), "markdown")
    assert "c is not ranked: attempted 1 world and not the same 2 as those that are." in text


def test_the_aggregate_shows_the_middle_half(board):
    text = render(board, "markdown")
    assert "### all scenarios, track unknown, leaders, 48 worlds" in text
    assert "| middle half |" in text


def test_json_is_tidy(board):
    rows = json.loads(render(board, "json"), parse_constant=pytest.fail)
    assert len(rows) == len(board.records)
    assert all(set(TIDY) <= set(r) for r in rows)
    keys = [tuple(r[k] for k in ("navigator", "scenario", "track", "role", "metric")) for r in rows]
    assert len(set(keys)) == len(keys)


def test_csv_holds_what_json_holds(board):
    tidy = json.loads(render(board, "json"))
    read = list(csv.DictReader(io.StringIO(render(board, "csv"))))
    for one, other in zip(tidy, read, strict=True):
        assert list(one) == list(other)
        assert other["value"] == ("" if one["value"] is None else repr(one["value"]))
        assert other["rank_low"] == ("" if one["rank_low"] is None else str(one["rank_low"]))


def test_named_metrics_alone_are_shown(board):
    rows = json.loads(render(board, "json", ["spl"]))
    assert {r["metric"] for r in rows} == {"spl"}
    assert "success" not in render(board, "markdown", ["spl"]).split("value [")[0]


@pytest.mark.parametrize("format", FORMATS)
def test_every_format_is_the_same_each_time_and_ends_its_last_line(board, format):
    assert render(board, format) == render(board, format)
    assert render(board, format).endswith("\n")
    assert render(Leaderboard((), ()), format).endswith("\n")


def test_columns_are_shown_in_the_order_in_which_they_are_named(board):
    text = render(board, "markdown", columns=["spl", "rank", "success"])
    (head, *_) = [line for line in text.splitlines() if line.startswith("| navigator")]
    assert re.split(r" *\| *", head)[1:-1] == ["navigator", "spl ↑", "rank", "success ↑"]
    html = render(board, "html", columns=["success", "mode"])
    assert "<th>navigator</th><th>success ↑</th><th>mode</th></tr>" in html
    many = render(board, "markdown", columns=["rank", "training", "middle_half", "verified", "spl"])
    assert re.search(r"rank +\| training \| middle half \| verified \| spl ↑", many)
    rows = json.loads(render(board, "json", columns=["rank", "spl"]))
    assert {r["metric"] for r in rows} == {"spl"}
    assert set(TIDY) <= set(rows[0])


@pytest.mark.parametrize("format", FORMATS)
def test_wrong_columns_are_refused(board, format):
    for columns, complaint in (
        (["success", "colided"], r"Got 'colided' instead\. Did you mean 'collided'"),
        (["success", "rnak"], r"Got 'rnak' instead\. Did you mean 'rank'"),
        (["rank"], "At least one column must be a metric"),
        ([], "At least one column must be a metric"),
    ):
        with pytest.raises(UsageError, match=complaint):
            render(board, format, columns=columns)
    with pytest.raises(UsageError, match="Columns name their metrics"):
        render(board, format, ["spl"], ["success"])


def test_wrong_wishes_are_refused(board):
    with pytest.raises(UsageError, match=r"one of markdown, csv, .* Did you mean 'latex'"):
        render(board, "latx")
    with pytest.raises(UsageError, match=r"Got 'sucess' instead\. Did you mean 'success'"):
        render(board, "markdown", ["sucess"])


class _Page(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.tags, self.cells = [], []

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, tuple(attrs)))

    def handle_data(self, data):
        self.cells.append(data)


@pytest.mark.parametrize("name", NASTY)
def test_html_shows_names_and_runs_nothing(name):
    page, plain = _Page(), _Page()
    page.feed(render(named(name), "html"))
    plain.feed(render(named("harmless"), "html"))
    assert page.tags == plain.tags
    assert escape.visible(name) in page.cells


@pytest.mark.parametrize("name", NASTY)
def test_markdown_keeps_its_columns_whatever_a_name_says(name):
    lines = render(named(name), "markdown").splitlines()[4:8]
    for line in lines:
        assert len(re.split(r"(?<!\\)\|", line)) == 5  # three columns
    assert not re.search(r"<|\x1b|(?<!\\)`|(?<!\\)\]\(", "".join(lines))


@given(st.text(max_size=30))
def test_markdown_text_cannot_end_a_cell(text):
    assert not re.search(r"(?<!\\)(\\\\)*\|", escape.markdown(text))
    assert "\n" not in escape.markdown(text)


@pytest.mark.parametrize("name", NASTY)
def test_spreadsheets_see_no_formula(name):
    for line in csv.reader(io.StringIO(render(named(name), "csv"))):
        assert line[0][:1] not in ("=", "+", "-", "@", "\t", "\r")


@settings(max_examples=20, deadline=None)
@given(st.text(alphabet=st.characters(exclude_categories=["Cs"]), min_size=1, max_size=12))
def test_json_gives_any_name_back(name):
    assert name in {r["navigator"] for r in json.loads(render(named(name), "json"))}


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (0.1234, "0.12"), (0.05, "0.050"), (1.234, "1.23"), (12.34, "12.3"),
     (1234.5, "1234"), (-3.456, "-3.46"), (0.000131, "0.00013"), (2.5e-7, "2.5e-07"),
     (5.2e-16, "0")],
)  # fmt: skip
def test_numbers_keep_about_three_figures(value, text):
    assert number(value) == text


@pytest.mark.parametrize(
    ("values", "unit", "text"),
    [([8.7e-7] * 2, "s", "870 ns"), ([2.25e-3] * 2, "s", "2.25 ms"), ([12.5] * 2, "s", "12.5 s"),
     ([1.5e-5, 2.5e-5], "s", "20 µs"), ([0.0] * 2, "s", "0 s"), ([5.12e8] * 2, "B", "512 MB"),
     ([0.002] * 2, "m", "0.0020 m")],
)  # fmt: skip
def test_seconds_and_bytes_take_a_prefix(values, unit, text):
    known = {"taken": metric("taken", "lower", unit=unit, verifiable=False)}
    board = leaderboard(table(scores({"a": values}, "taken")), known)
    shown = render(board, "markdown").split("value [")[0]
    assert text in re.sub(r" \[.*?\]", "", shown)
    assert {r.unit for r in board.records} == {unit}
    assert render(board, "latex").isascii()


def test_what_training_cost_stands_beside_success():
    rows = scores({"learner": [1.0, 0.0], "plain": [0.0, 1.0]})
    board = leaderboard(table(rows), METRICS, training={"learner": (6.5e6, 2300.0)})
    text = render(board, "markdown")
    assert re.search(r"\| learner .*\| 6\.5 M, 38 min ", text)
    assert re.search(r"success ↑ +\| training", text)
    assert "6.5 M, 38 min" in render(board, "markdown", ["all"])
    kept = {r["navigator"]: r["training_decisions"] for r in json.loads(render(board, "json"))}
    assert kept == {"learner": 6.5e6, "plain": None}
    assert "training" not in render(leaderboard(table(rows), METRICS), "markdown")


def test_a_profile_stands_for_its_metrics_that_are_held():
    held = ("intrusion", "spl", "success", "avoidance")
    assert choose(held, ["people", "spl"]) == ("success", "intrusion", "avoidance", "spl")
    assert choose(held, ["intrusion", "people"])[:2] == ("intrusion", "success")
    with pytest.raises(UsageError, match=r"Got 'poeple' instead\. Did you mean 'people'"):
        choose(held, ["poeple"])
