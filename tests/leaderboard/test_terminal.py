"""Tables on a terminal: nothing wraps, nothing is lost, the most general table is first."""

import io
import re

import numpy as np
import pytest

from benchnav.leaderboard import NotApplicable, leaderboard, render
from benchnav.leaderboard.rendering.terminal import TerminalTables, terminal
from tests.leaderboard.tables import METRICS, scores, simulated, table

REASON = "its planner 'grid.astar' needs a map and the track 'unknown' grants none to any navigator"


@pytest.fixture(scope="module")
def board():
    rows = simulated(["alpha", "ompl.rrt-connect+recurrent-ppo-plus", "gamma"], 4, 12,
                     np.random.default_rng(2), tracks=("known", "unknown"))  # fmt: skip
    missing = [NotApplicable(name, "leaders/s0@1", "unknown", REASON) for name in ("m1", "m2")]
    modes = dict.fromkeys(("alpha", "gamma"), "in-process")
    modes["ompl.rrt-connect+recurrent-ppo-plus"] = "in-process"
    return leaderboard(table(rows), METRICS, missing, modes=modes | {"m1": "in-process"})


@pytest.mark.parametrize("width", [60, 80, 120])
def test_every_line_fits_and_every_number_of_the_markdown_is_shown(board, width):
    text = terminal(board, width=width)
    assert max(map(len, text.splitlines())) <= width
    for line in render(board, "markdown").splitlines():
        if line.startswith("| gamma"):
            cells = [cell.strip().strip("*") for cell in line.strip("|").split("|")]
            assert all(cell in text for cell in cells)


def test_the_table_over_all_scenarios_is_the_first_of_its_track(board):
    titles = re.findall(r"^(all scenarios|leaders/s\d@1), track (\w+)", terminal(board, width=80),
                        re.M)  # fmt: skip
    scenarios = ["all scenarios", *(f"leaders/s{k}@1" for k in range(4))]
    assert titles == [(name, track) for track in ("known", "unknown") for name in scenarios]


def test_long_reasons_are_footnotes_with_one_number_for_equal_reasons(board):
    text = render(board, "markdown")
    part = text.split("### leaders/s0@1, track unknown")[1].split("###")[0]
    assert part.count("n/a [1]") == 2
    assert part.count(f"[1] {REASON}") == 1
    assert "n/a [1]" in terminal(board, width=80)


def test_a_mode_is_a_column_where_modes_differ():
    rows = table(scores({"a": [1.0, 0.0], "b": [0.0, 1.0]}))
    same = leaderboard(rows, METRICS, modes={"a": "isolated", "b": "isolated"})
    other = leaderboard(rows, METRICS, modes={"a": "isolated", "b": "in-process"})
    for shown in (render(same, "markdown"), terminal(same, width=80)):
        assert "mode: isolated for all entries." in shown
        assert shown.count("isolated") == 1
    assert "| mode" in render(other, "markdown")
    assert "| mode" in render(same, "markdown", columns=["success", "mode"])


def test_verified_marks_are_kept():
    rows = table(scores({"a": [1.0, 0.0], "b": [0.0, 1.0]}))
    text = terminal(leaderboard(rows, METRICS, verified={"a"}), width=80)
    assert re.search(r"^a .* yes$", text, re.M)
    assert re.search(r"^b .* no$", text, re.M)


def test_only_our_own_escape_sequences_reach_a_terminal(monkeypatch):
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    rows = table(scores({"\x1b[31mred": [1.0] * 20, "[bold]b": [0.0] * 20}))
    board = leaderboard(rows, METRICS)
    text = terminal(board, width=80, styled=True)
    assert set(re.findall(r"\x1b\[\d*m", text)) <= {"\x1b[1m", "\x1b[2m", "\x1b[0m"}
    assert re.search(r"\x1b\[1m1 \[[\d.]+, 1\]", text)  # the best is bold
    assert "\x1b" not in terminal(board, width=80)
    assert "[bold]b" in text  # no markup


def test_rich_prints_the_tables_at_the_width_of_its_console(board):
    from rich.console import Console

    console = Console(width=70, record=True, file=io.StringIO())
    console.print(TerminalTables(board))
    assert max(map(len, console.export_text().splitlines())) <= 70
