"""Where stdout and stderr lead: to other code pages, full disks, closed pipes, or nowhere."""

import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

COMMAND = f"{shlex.quote(sys.executable)} -c 'from benchnav.cli.main import main; main()'"
FULL = "/dev/full"
needs_full = pytest.mark.skipif(not Path(FULL).exists(), reason="there is no /dev/full")


def shell(line, folder=None, **environment):
    """(exit status, bytes of stdout, text of stderr) of a line in which B is the command."""
    done = subprocess.run(
        ["bash", "-c", line.replace("B ", COMMAND + " ")], cwd=folder, capture_output=True,
        env={**os.environ, **environment}, check=False,
    )  # fmt: skip
    stderr = done.stderr.decode("utf-8", "replace")
    assert "Traceback" not in stderr
    assert "Exception ignored" not in stderr
    return done.returncode, done.stdout, stderr


SCENARIO = """
name: tiny/café
title: "µ ↑ – × é … 道 two discs"
bounds: [-3, -3, 3, 3]
teams:
  - {name: pair, count: 2, radius: 0.2, max_speed: 1, start: {type: circle, radius: 2},
     goal: {type: antipodal}}
"""


@pytest.mark.parametrize(
    ("encoding", "title"),
    [
        ("utf-8", "µ ↑ – × é … 道 two discs".encode()),
        ("latin-1", "µ ^ - × é ... \\u9053 two discs".encode("latin-1")),
        ("cp1252", "µ ^ – × é … \\u9053 two discs".encode("cp1252")),
        ("ascii", b"u ^ - x e ... \\u9053 two discs"),
        ("ascii:strict", b"u ^ - x e ... \\u9053 two discs"),
    ],
)
def test_every_code_page_carries_the_text_in_its_own_characters(encoding, title, tmp_path):
    (tmp_path / "s.yaml").write_text(SCENARIO.replace("café", "cafe"), encoding="utf-8")
    code, stdout, _ = shell("B show s.yaml", tmp_path, PYTHONIOENCODING=encoding)
    assert code == 0
    assert title in stdout


@pytest.mark.parametrize(
    "locale", [{"LANG": "C"}, {"LC_ALL": "POSIX"}, {"LC_ALL": "C", "PYTHONUTF8": "0"}]
)
def test_every_locale_carries_the_text(locale):
    without = {"PYTHONIOENCODING": "", "PYTHONCOERCECLOCALE": "0", **locale}
    for line in ("B list", "B --help", "B schema", "B show spl", "B run --help"):
        code, stdout, stderr = shell(line, **without)
        assert (code, stderr) == (0, "")
        assert stdout


def test_help_on_a_terminal_without_such_characters_is_spelled_in_ascii():
    code, stdout, _ = shell("B run --help", PYTHONIOENCODING="ascii")
    assert code == 0
    assert b"Scenarios x tracks x perceptions x navigators x seeds" in stdout
    code, _, stderr = shell("B run quick --scenario trap/ü", PYTHONIOENCODING="ascii")
    assert code == 2
    assert stderr.isascii()


def test_json_stays_json_in_every_code_page():
    said = {e: shell("B schema", PYTHONIOENCODING=e)[1] for e in ("utf-8", "ascii", "latin-1")}
    assert {*map(str, map(sorted, map(json.loads, said.values())))} == {
        str(sorted(json.loads(said["utf-8"])))
    }


def test_the_name_of_a_file_that_is_no_text_keeps_its_bytes(tmp_path):
    code, stdout, _ = shell("B new navigator my-idea --out $'a\\xff'", tmp_path)
    assert (code, stdout) == (0, b"a\xff\n")


@needs_full
@pytest.mark.parametrize("line", ["B list", "B schema", "B show orca", "B doctor", "B --help"])
def test_a_full_disk_behind_stdout_is_one_sentence(line):
    code, _, stderr = shell(f"{line} > {FULL}")
    assert code == 1
    assert stderr.count("\n") == 1
    assert "No space left on device" in stderr


@needs_full
def test_a_mistake_is_told_though_stdout_is_full():
    code, _, stderr = shell(f"B show orac > {FULL}")
    assert code == 2
    assert "Did you mean 'orca'" in stderr


@pytest.mark.parametrize("closed", [">&-", "2>&-", "<&-", "<&- >&- 2>&-", "2>&- | cat"])
@pytest.mark.parametrize(("verb", "status"), [("schema", 0), ("show orac", 2)])
def test_closed_streams_change_nothing_of_the_exit_status(closed, verb, status, tmp_path):
    assert shell(f"set -o pipefail; B {verb} {closed}", tmp_path)[0] == status
    assert list(tmp_path.iterdir()) == []


@needs_full
def test_talk_that_cannot_be_written_does_not_stop_the_work(tmp_path):
    code, stdout, _ = shell(f"B new navigator my-idea 2> {FULL}", tmp_path)
    assert (code, stdout) == (0, b"my-idea\n")


@pytest.mark.parametrize("verb", ["schema", "list", "show orca", "doctor", "--help"])
def test_a_reader_that_leaves_early_changes_nothing_of_the_exit_status(verb):
    code, stdout, stderr = shell(f"set -o pipefail; B {verb} | head -n 1")
    assert (code, stderr) == (0, "")
    assert stdout.count(b"\n") == 1
    assert shell(f"set -o pipefail; B {verb} | true")[0::2] == (0, "")


@pytest.mark.long
@needs_full
def test_a_run_is_kept_though_its_streams_fail(suite):
    """What its navigators print cannot be written either, and costs them nothing."""
    (suite.parent / "talks.py").write_text(
        "from benchnav_baselines.navigators.straight_line import StraightLine\n\n\n"
        "class Talks(StraightLine):\n"
        "    def act(self, observation):\n"
        "        print('↑' * 10_000, flush=True)\n"
        "        return super().act(observation)\n"
    )
    line = f"B run {suite} --navigator talks:Talks --workers 1 --seeds 1 --out"
    assert shell(f"{line} a > {FULL} 2>&1", suite.parent)[0] == 1
    code, _, stderr = shell(f"{line} a 2> /dev/null; B leaderboard a", suite.parent)
    assert code == 0
    assert "failed" not in stderr
    assert shell(f"{line} b <&- >&- 2>&-", suite.parent)[0] == 0
    code, table, _ = shell("B leaderboard b", suite.parent, PYTHONIOENCODING="latin-1")
    assert code == 0
    assert b", 1 world\n" in table
    assert "µs".encode("latin-1") in table
    check = "B verify b --twin 0"
    status = f"set -o pipefail; {check} | true; echo $?; {check} > /dev/null; echo $?"
    assert shell(status, suite.parent)[1].split() == [b"0", b"0"]
