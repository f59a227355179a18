"""`benchnav leaderboard` prints a fitted table on a terminal and Markdown into a pipe."""

import sys

import pytest

from benchnav.cli.main import status


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = str(tmp_path_factory.mktemp("runs") / "run")
    command = ["run", "circle/antipodal", "--navigator", "straight-line", "--seeds", "1"]
    assert status([*command, "--workers", "0", "--quiet", "--out", folder]) == 0
    return folder


def shown(run, capfd, *options):
    capfd.readouterr()
    assert status(["leaderboard", run, *options]) == 0
    return capfd.readouterr().out


def test_a_terminal_gets_a_table_of_its_width(run, capfd, monkeypatch):
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setenv("TERM", "xterm")
    text = shown(run, capfd)
    assert "\x1b[1m" in text
    assert "|" not in text
    assert "| navigator" in shown(run, capfd, "--format", "markdown")


def test_a_pipe_gets_markdown_or_what_was_asked_for(run, capfd, monkeypatch):
    monkeypatch.setenv("COLUMNS", "70")
    assert "| navigator" in shown(run, capfd)
    text = shown(run, capfd, "--format", "terminal")
    assert "\x1b" not in text
    assert max(map(len, text.splitlines())) <= 70
