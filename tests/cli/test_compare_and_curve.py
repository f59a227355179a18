"""Comparisons and curves from the command line; what is not shown is not computed."""

import json

import pytest

from benchnav.cli import board


@pytest.fixture
def run(call, suite, tmp_path):
    assert call("run", suite, "--out", tmp_path / "out", "--workers", 0, "--quiet")[0] == 0
    return tmp_path / "out"


def test_two_navigators_are_compared_in_words(call, run):
    code, stdout, stderr = call("leaderboard", run, "--compare", "straight-line", "orca")
    assert (code, stderr) == (0, "")
    lines = [line for line in stdout.splitlines() if line.startswith("- ")]
    assert len(lines) == 2
    assert "track known, leaders, success: straight-line − orca = " in lines[0]
    code, stdout, _ = call(
        "leaderboard", run, "--compare", "orca", "straight-line", "--metric", "path_length",
        "--metric", "spl", "--format", "json",
    )  # fmt: skip
    assert [r["metric"] for r in json.loads(stdout)] == ["path_length"] * 2 + ["spl"] * 2
    code, _, stderr = call("leaderboard", run, "--compare", "orca", "straightline")
    assert code == 2
    assert "Did you mean 'straight-line'" in stderr


def test_success_is_shown_against_time(call, run, tmp_path):
    code, stdout, stderr = call("leaderboard", run, "--curve", "success")
    assert (code, stderr) == (0, "")
    assert stdout.count("| orca") == stdout.count("| straight-line") == 2
    file = tmp_path / "curve.csv"
    code, nothing, _ = call(
        "leaderboard", run, "--curve", "success", "--format", "csv", "--out", file
    )
    assert (code, nothing) == (0, "")
    assert len(file.read_text().splitlines()) == 1 + 4 * 100
    for wrong in (["--curve", "sucess"], ["--curve", "success", "--metric", "spl"]):
        assert call("leaderboard", run, *wrong)[0] == 2


def test_only_what_is_shown_is_computed(call, run, monkeypatch):
    seen, real = [], board.leaderboard

    def counted(results, *rest):
        seen.append(set(results["metric"].unique().to_pylist()))
        return real(results, *rest)

    monkeypatch.setattr(board, "leaderboard", counted)
    assert call("leaderboard", run, "--metric", "spl")[0] == 0
    assert call("leaderboard", run)[0] == 0
    assert call("leaderboard", run, "--format", "csv")[0] == 0
    assert seen[0] == {"spl"}
    assert "success" in seen[1]
    assert "path_length" not in seen[1]
    assert "path_length" in seen[2]


def test_runs_of_two_navigators_under_one_label_are_refused_by_name(call, suite, tmp_path):
    runs = [tmp_path / "one", tmp_path / "two"]
    text = suite.read_text()
    for run, name in zip(runs, ("orca", "straight-line"), strict=True):
        suite.write_text(text.replace("[orca, straight-line]", f"[{{type: {name}, label: x}}]"))
        assert call("run", suite, "--out", run, "--workers", 0, "--quiet")[0] == 0
    code, stdout, stderr = call("leaderboard", *runs)
    assert (code, stdout) == (2, "")
    assert "'x' must stand for one navigator" in stderr
    assert str(runs[0]) in stderr
    assert str(runs[1]) in stderr
