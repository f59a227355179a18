"""--out gives the format by its suffix; --format must agree with it."""

import csv
import json

import pytest

from benchnav.cli.main import status
from benchnav.cli.tables.leaderboard import FORMATS
from tests.cli.conftest import TINY

BEGINNINGS = {
    "t.md": "## Track known", "t.MARKDOWN": "## Track known", "t.csv": "navigator,scenario,",
    "t.tex": "% Needs \\usepackage{booktabs}", "t.html": "<!doctype html>",
    "t.htm": "<!doctype html>", "t.json": "[\n{",
}  # fmt: skip


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("out-format")
    (folder / "open.yaml").write_text(TINY)
    (folder / "suite.yaml").write_text(
        "name: tiny\nscenarios: [open.yaml]\nnavigators: [orca, straight-line]\nseeds: 2\n"
    )
    arguments = ["run", folder / "suite.yaml", "--out", folder / "run", "--workers", 0, "--quiet"]
    assert status([str(argument) for argument in arguments]) == 0
    return folder / "run"


def test_a_table_is_written_as_its_file_ends(call, run, tmp_path):
    for name, beginning in BEGINNINGS.items():
        file = tmp_path / name
        assert call("leaderboard", run, "--out", file)[0] == 0
        assert file.read_text(encoding="utf-8").startswith(beginning), name
    file = tmp_path / "t.csv"
    assert call("leaderboard", run, "--format", "csv", "--out", file)[0] == 0
    assert call("leaderboard", run, "--format", "csv", "--out", tmp_path / "without")[0] == 0
    assert (tmp_path / "without").read_text() == file.read_text()
    for name, end in (("c.csv", "csv"), ("c.json", "json")):
        curve = tmp_path / name
        assert call("leaderboard", run, "--curve", "horizon", "--out", curve)[0] == 0
        text = curve.read_text()
        assert json.loads(text) if end == "json" else list(csv.DictReader(text.splitlines()))


def test_a_comparison_is_written_as_its_file_ends(call, run, tmp_path):
    for name, beginning in (
        ("c.md", "# orca against"),
        ("c.csv", "first,second,"),
        ("c.json", "["),
    ):
        file = tmp_path / name
        assert call("compare", run, "orca", "straight-line", "--out", file)[0] == 0
        assert file.read_text().startswith(beginning)


@pytest.mark.parametrize(
    ("verb", "options", "complaint"),
    [
        ("leaderboard", ("--out", "t.txt"), ".md (markdown), .markdown (markdown), .csv (csv)"),
        ("leaderboard", ("--out", "t.jsn"), "Did you mean '.json'"),
        ("leaderboard", ("--out", "t"), "--out must end in one of"),
        ("leaderboard", ("--out", "t.tex", "--format", "csv"), "--format and --out must agree"),
        ("leaderboard", ("--out", "t.txt", "--format", "csv"), "--out must end in one of"),
        ("leaderboard", ("--format", "latx"), "Did you mean 'latex'"),
        ("leaderboard", ("--curve", "horizon", "--out", "t.tex"), ".json (json), .png, .svg, .pdf"),
        ("leaderboard", ("--curve", "horizon", "--out", "t.png", "--format", "csv"), "must agree"),
        ("leaderboard", ("--curve", "horizon", "--format", "latex"), "markdown, csv, json"),
        ("leaderboard", ("--curve", "horizon", "--columns", "spl"), "has no columns"),
        ("leaderboard", ("--columns", "success,colided"), "Did you mean 'collided'"),
        ("leaderboard", ("--columns", "rank"), "At least one column must be a metric"),
        ("leaderboard", ("--columns", "spl", "--metric", "spl"), "Got both"),
        ("compare", ("orca", "straight-line", "--out", "t.html"), ".csv (csv), .json (json), .png"),
        ("compare", ("orca", "straight-line", "--out", "t.csv", "--format", "json"), "must agree"),
    ],
)
def test_what_does_not_agree_is_refused_and_nothing_written(
    call, run, tmp_path, monkeypatch, verb, options, complaint
):
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    code, stdout, stderr = call(verb, run, *options)
    assert (code, stdout) == (2, "")
    assert complaint in stderr
    assert not list(folder.iterdir())


@pytest.mark.parametrize("format", FORMATS)
def test_columns_are_those_that_are_named(call, run, format):
    code, text, _ = call("leaderboard", run, "--columns", "spl, success", "--format", format)
    assert code == 0
    assert "spl" in text
    assert "collided" not in text.split("value ")[0]
