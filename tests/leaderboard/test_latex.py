"""LaTeX compiles with booktabs alone, fits the text of an article, and shows any name."""

import re
import shutil
import subprocess

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchnav.leaderboard import NotApplicable, leaderboard, render
from benchnav.leaderboard.rendering.latex import TEXT_WIDTH
from benchnav.leaderboard.rendering.latex_text import breakable, latex, width
from tests.leaderboard.tables import METRICS, scores, simulated, table

NASTY = (
    "näv_igator#1 & co %", "−↑↓→←↔–—×÷·µ≤≥≠≈±∞√…°", "αβγδεζηθικλμνξοπρστυφχψω ΑΒΓΔΘΛΞΠΣΥΦΨΩ ς ά",
    "中文 導航 🤖", "Łódź ąę đ ß æøå ÆØÅ œ ñ ç š ž ő î ï ĵ", "Привет", "x² y₁ ½ ﬁ Ａ ™ ℃ №",
    r"\input{/etc/passwd} $x_1$ 50% #1 & ~^{}", "<<a>> --- '' `` \" ,, ?` !` [x] | / @ * =", "[",
    "]",
    "a" * 80, "W" * 80, "m-" * 40, "%", "\\", "end{tabular}", "\x1b[31mred\x1b[0m", "a\nb\r\n- c",
    "¿qué? «sí» “no” ‘x’ £ € © ®", "\u0301combining \u0308", "ﬀ", "·" * 30,
)  # fmt: skip

needs_pdflatex = pytest.mark.skipif(
    shutil.which("pdflatex") is None, reason="pdflatex is not installed"
)


def compiled(body, folder, encoding=""):
    """The log of pdflatex; the document holds nothing but ``body``."""
    (folder / "tables.tex").write_text(body, encoding="utf-8")
    (folder / "paper.tex").write_text(
        f"\\documentclass{{article}}\n{encoding}\\usepackage{{booktabs}}\n"
        f"\\begin{{document}}\n\\input{{tables}}\n\\end{{document}}\n"
    )
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "paper.tex"]
    for _ in range(2):  # the second time, labels are known
        done = subprocess.run(command, cwd=folder, capture_output=True, check=False, timeout=120)
    log = (folder / "paper.log").read_text(encoding="latin-1")
    assert done.returncode == 0, log[-2000:]
    return log


def require_fit(log):
    assert re.findall(r"^(?:Overfull|LaTeX Warning|! ).*", log, re.MULTILINE) == []


def crowded(navigators, scenarios, rng=0, tracks=("unknown",)):
    rows = simulated(navigators, scenarios, 6, np.random.default_rng(rng), tracks)
    missing = [NotApplicable("mapper", f"leaders/s{s}@1", "unknown", "needs a map")
               for s in range(scenarios)]  # fmt: skip
    return leaderboard(table(rows), METRICS, missing)


@needs_pdflatex
@pytest.mark.slow
@pytest.mark.parametrize("encoding", ["", "\\usepackage[T1]{fontenc}\n"])
def test_any_name_compiles_and_fits(tmp_path, encoding):
    rows = [r for k, name in enumerate(NASTY) for r in scores({name: [1.0, 0.0, k % 2]})]
    board = leaderboard(table(rows), METRICS)
    require_fit(compiled(render(board, "latex"), tmp_path, encoding))
    words = "\n\n".join(f"\\noindent\\fbox{{{latex(name)}}}\n" for name in NASTY if len(name) < 60)
    compiled(words, tmp_path, encoding)


@needs_pdflatex
@pytest.mark.slow
def test_a_large_board_compiles_and_fits(tmp_path):
    names = [f"planner.variant-{n}+controller" for n in range(17)]
    board = crowded(names, 34)
    matrix = render(board, "latex")
    require_fit(compiled(matrix, tmp_path))
    assert 3 <= matrix.count(r"\begin{table}") < 10
    columns = ["rank", "success", "collided", "spl", "time_to_goal", "latency_p50", "verified"]
    require_fit(compiled(render(crowded(names, 3), "latex", columns=columns), tmp_path))


@needs_pdflatex
@pytest.mark.slow
def test_texts_are_not_wider_than_is_thought(tmp_path):
    names = [
        *(n for n in NASTY if len(n) < 60),
        "corridor/bidirectional@1:agents=16",
        "0.85 [0.1, 1]",
    ]
    lines = [r"\newdimen\x \footnotesize"]
    for name in names:
        lines.append(rf"\setbox0\hbox{{{latex(name)}}}\typeout{{WIDTH \the\wd0}}")
        lines.append(rf"\setbox0\hbox{{\textbf{{{latex(name)}}}}}\typeout{{WIDTH \the\wd0}}")
    log = compiled("\n".join(lines), tmp_path)
    found = [float(x) for x in re.findall(r"^WIDTH ([\d.]+)pt", log, re.MULTILINE)]
    assert len(found) == 2 * len(names)
    for name, plain, bold in zip(names, found[::2], found[1::2], strict=True):
        assert plain <= 8.0 * width(name) + 0.5, name
        assert bold <= 1.15 * 8.0 * width(name) + 0.5, name
        assert not name.isascii() or 8.0 * width(name) <= 1.4 * plain + 5.0, name


def test_the_default_is_one_matrix_of_navigators_and_scenarios():
    text = render(crowded(["alpha", "beta"], 4), "latex")
    assert text.count(r"\begin{table}") == text.count(r"\caption{") == text.count(r"\label{") == 1
    assert r"\label{tab:success-unknown-leader}" in text
    assert "success (higher is better) of leaders, track unknown: means over 6 worlds" in text
    head = text.split(r"\toprule")[1].split(r"\midrule")[0]
    plain = re.sub(r"\\scriptsize |\\begin\{.*?\}\[b\]\{.*?\}\}|\\end\{.*?\}", "", head)
    scenarios = " & ".join(f"leaders/ \\\\ s{k}@1" for k in range(4))
    assert plain.strip() == (f"navigator & rank & all scenarios & {scenarios} \\tabularnewline")
    rows = re.findall(
        r"^    (alpha|beta|mapper) & (\S+) & (.*?) & (.*) \\tabularnewline", text, re.M
    )
    assert [name for name, *_ in rows] == ["beta", "alpha", "mapper"]
    assert all(
        re.search(r"0\.\d+ \{\[\}0\.\d+, 0\.\d+\{\]\}", whole) for _, _, whole, _ in rows[:2]
    )
    assert rows[2][1:] == ("{--}", "n/a", "n/a & n/a & n/a & n/a")
    assert "n/a (needs a map): mapper." in text.replace(r"\allowbreak{}", "")


def test_named_metrics_have_a_matrix_each_and_named_columns_a_table_a_scenario():
    board = crowded(["alpha", "beta"], 2)
    text = render(board, "latex", ["spl", "success"])
    assert re.findall(r"\\label\{(.*)\}", text) == ["tab:spl-unknown-leader",
                                                    "tab:success-unknown-leader"]  # fmt: skip
    text = render(board, "latex", columns=["success", "spl"])
    assert re.findall(r"\\label\{(.*)\}", text) == [
        "tab:all-unknown-leader", "tab:leaders-s0-1-unknown-leader",
        "tab:leaders-s1-1-unknown-leader",
    ]  # fmt: skip
    assert "rank" not in text.split("value ")[0]


def test_labels_are_unique_where_names_read_alike():
    rows = scores({"a": [1.0, 0.0]}, scenario="leaders/a-b@1", scenario_hash="1" * 16)
    rows += scores({"a": [1.0, 0.0]}, scenario="leaders/a_b@1", scenario_hash="2" * 16)
    labels = re.findall(
        r"\\label\{(.*)\}",
        render(leaderboard(table(rows), METRICS), "latex", columns=["success"]),
    )
    assert len(labels) == len(set(labels)) == 3


def test_wide_boards_are_split_and_say_so():
    text = render(crowded(["alpha", "beta"], 20), "latex")
    parts = text.count(r"\begin{table}")
    assert parts > 1
    assert text.count(f", part {parts} of {parts}.") == 1
    assert text.count(r"    alpha & ") == parts
    assert TEXT_WIDTH == 345.0


def test_the_first_lines_say_which_packages_are_needed():
    text = render(crowded(["alpha"], 1), "latex")
    assert text.startswith("% Needs \\usepackage{booktabs} and nothing else")
    assert "\\usepackage" not in text.partition("\n")[2]


@given(st.text(max_size=30))
def test_text_holds_no_command_of_its_own(text):
    for shown in (latex(text), breakable(text)):
        assert shown.isascii()
        bare = re.sub(
            r"\\[A-Za-z]+\{\}|\\[&%$#_{}]|\\['`^~=.\"HcdbruvHT]\{(\\[ij]|[A-Za-z])\}", "", shown
        )
        bare = re.sub(r"\$(\\[A-Za-z]+|[-o']|''|\^\\circ|[\^_]\{\\mathrm\{[^$]*?\}\})\$", "", bare)
        bare = re.sub(r"\{([][`']|``|''|--|---|[!?]`)\}|\{\}", "", bare)
        assert not set(bare) & set("\\&%$#_{}~^"), bare
