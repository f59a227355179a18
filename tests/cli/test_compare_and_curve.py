"""Comparisons and curves from the command line; what is not shown is not computed."""

import json

import pytest

from benchnav.leaderboard import from_runs


@pytest.fixture
def run(call, suite, tmp_path):
    assert call("run", suite, "--out", tmp_path / "out", "--workers", 0, "--quiet")[0] == 0
    return tmp_path / "out"


def test_two_navigators_are_compared_in_words(call, run):
    code, stdout, stderr = call("compare", run, "straight-line", "orca")
    assert (code, stderr) == (0, "")
    assert stdout.startswith("# straight-line against orca\n\n## success: ")
    assert (
        "- tiny/open@1, track known (2 worlds): too few worlds to tell, straight-line − " in stdout
    )
    wanted = ["--metric", "path_length", "--metric", "spl", "--format", "json"]
    code, stdout, _ = call("compare", run, "orca", "straight-line", *wanted)
    assert [r["metric"] for r in json.loads(stdout)] == ["path_length"] * 2 + ["spl"] * 2
    wanted = ["--scenario", "tiny/open", "--metric", "success", "--format", "json"]
    assert len(json.loads(call("compare", run, run, "orca", "straight-line", *wanted)[1])) == 2


@pytest.mark.parametrize(
    ("wrong", "complaint"),
    [
        (("orca", "straightline"), "Did you mean 'straight-line'"),
        (("orca",), "needs a run and two navigators"),
        (("tiny/open:size=3", "orca"), "'tiny/open:size=3' is a scenario"),
        (("orca", "straight-line", "--scenario", "tiny/opne"), "Did you mean 'tiny/open'"),
        (("orca", "straight-line", "--metric", "sucess"), "Did you mean 'success'"),
        (("orca", "straight-line", "--format", "html"), "markdown, csv, json"),
    ],
)
def test_who_compares_wrongly_is_told(call, run, wrong, complaint):
    code, stdout, stderr = call("compare", run, *wrong)
    assert (code, stdout) == (2, "")
    assert complaint in stderr


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_a_comparison_and_a_curve_are_drawn(call, run, tmp_path, suffix):
    pytest.importorskip("matplotlib")
    files = [tmp_path / f"{name}.{suffix}" for name in ("compare", "curve")]
    code, stdout, stderr = call("compare", run, "orca", "straight-line", "--out", files[0])
    assert (code, stderr) == (0, f"{files[0]} is drawn\n")
    assert stdout.startswith("# orca against straight-line")
    code, stdout, stderr = call("leaderboard", run, "--curve", "horizon", "--out", files[1])
    assert (code, stdout, stderr) == (0, "", f"{files[1]} is drawn\n")
    magic = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}[suffix]
    assert all(file.read_bytes().startswith(magic) for file in files)
    code, _, stderr = call("leaderboard", run, "--out", tmp_path / f"table.{suffix}")
    assert code == 2
    assert "A table is no picture" in stderr


def test_success_is_shown_against_time(call, run, tmp_path):
    code, stdout, stderr = call("leaderboard", run, "--curve", "horizon")
    assert (code, stderr) == (0, "")
    assert stdout.count("| orca") == stdout.count("| straight-line") == 2
    file = tmp_path / "curve.csv"
    code, nothing, _ = call(
        "leaderboard", run, "--curve", "horizon", "--format", "csv", "--out", file
    )
    assert (code, nothing) == (0, "")
    assert len(file.read_text().splitlines()) == 1 + 4 * 100
    for wrong, complaint in (
        (["--curve", "horizn"], "Did you mean 'horizon'"),
        (["--curve", "horizon", "--metric", "spl"], "there is success alone"),
        (["--curve", "horizon", "--metric", "spl", "--metric", "success"], "of one metric"),
    ):
        code, _, stderr = call("leaderboard", run, *wrong)
        assert code == 2
        assert complaint in stderr


def test_a_metric_is_shown_against_a_parameter_with_its_default(call, suite, tmp_path):
    scenario = suite.parent / "open.yaml"
    declared = (
        "parameters:\n  size: {default: 0.2, low: 0.1, high: 0.3, description: 'of a disc [m]'}"
    )
    text = scenario.read_text().replace("radius: 0.2", "radius: {parameter: size}")
    scenario.write_text(f"{text}{declared}\n")
    suite.write_text(suite.read_text().replace("[open.yaml]", "[open.yaml, 'open.yaml:size=0.3']"))
    out = tmp_path / "out"
    assert call("run", suite, "--out", out, "--workers", 0, "--quiet")[0] == 0
    wanted = ["--curve", "size", "--metric", "spl", "--format", "json"]
    rows = json.loads(call("leaderboard", out, *wanted)[1])
    assert {(r["scenario"], r["axis_unit"], r["x"], r["metric"]) for r in rows} == {
        ("tiny/open@1", "m", 0.2, "spl"), ("tiny/open@1", "m", 0.3, "spl"),
    }  # fmt: skip
    for name, count in (("tiny/open", 6), ("tiny/open@1:size=0.3", 2), ("tiny/open:size=0.3", 2)):
        wanted = ["--scenario", name, "--metric", "spl", "--format", "json"]
        assert len(json.loads(call("compare", out, "orca", "straight-line", *wanted)[1])) == count
    code, _, stderr = call("leaderboard", out, "--curve", "sise")
    assert code == 2
    assert "a number parameter of a scenario that was run: size. Got 'sise'" in stderr


def test_only_what_is_shown_is_computed(call, run, monkeypatch):
    seen, real = [], from_runs.leaderboard

    def counted(results, *rest):
        seen.append(set(results["metric"].unique().to_pylist()))
        return real(results, *rest)

    monkeypatch.setattr(from_runs, "leaderboard", counted)
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
