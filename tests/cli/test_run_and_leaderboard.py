"""From a suite to a table: results on stdout, talk on stderr."""

import csv
import io
import json
import re

import pytest

from benchnav.metrics.metric import Metric
from benchnav.plugins import METRICS
from benchnav.store.parts.part import RESULTS_FILE
from benchnav.store.runs.reading import read_episodes


@pytest.fixture
def run(call, suite, tmp_path):
    out = tmp_path / "out"
    code, stdout, stderr = call("run", suite, "--out", out, "--workers", 0)
    assert (code, stdout) == (0, f"{out}\n")
    assert "tiny@1: 1 scenario × 2 tracks × 2 navigators × 2 seeds" in stderr
    assert "4 of 4 episodes" in stderr
    assert "4 episodes stored, 4 of them run in" in stderr
    return out


def test_a_second_run_finds_everything_and_a_quiet_one_says_nothing(call, suite, run):
    code, stdout, stderr = call("run", suite, "--out", run, "--workers", 0)
    assert "4 episodes stored, 0 of them run" in stderr
    code, stdout, stderr = call("run", suite, "--out", run, "--workers", 0, "--quiet")
    assert (code, stdout, stderr) == (0, f"{run}\n", "")


def test_the_salt_of_a_run_repeats_it_elsewhere(call, suite, run, tmp_path):
    salt = json.loads((run / "manifest.json").read_text())["salt"]
    again, other = tmp_path / "again", tmp_path / "other"
    for out, options in ((again, ("--salt", salt)), (other, ())):
        code, *_ = call("run", suite, "--out", out, "--workers", 0, "--quiet", *options)
        assert code == 0
    digests = [{e.identity: e.digest for e in read_episodes(out)} for out in (run, again, other)]
    assert digests[0] == digests[1] != digests[2]
    code, _, stderr = call("run", suite, "--out", run, "--salt", "00")
    assert code == 1
    assert salt in stderr
    code, _, stderr = call("run", suite, "--out", tmp_path / "no", "--salt", "0x1")
    assert code == 2
    assert "The salt must be 1 to 64 bytes" in stderr


@pytest.mark.parametrize("format", ["markdown", "csv", "latex", "html", "json"])
def test_the_table_comes_in_every_format(call, run, tmp_path, format):
    code, stdout, stderr = call("leaderboard", run, "--format", format)
    assert (code, stderr) == (0, "")
    assert "straight-line" in stdout
    assert "tiny/open" in stdout.replace(r"\allowbreak{}", "")
    file = tmp_path / "table"
    code, nothing, talk = call("leaderboard", run, "--format", format, "--out", file)
    assert (code, nothing) == (0, "")
    assert file.read_text().rstrip("\n") == stdout.rstrip("\n")
    assert str(file) in talk


def test_machines_get_a_record_per_metric(call, run):
    rows = json.loads(call("leaderboard", run, "--format", "json")[1])
    found = list(csv.DictReader(io.StringIO(call("leaderboard", run, "--format", "csv")[1])))
    assert len(rows) == len(found) > 0
    columns = {"navigator", "scenario", "track", "role", "metric", "value", "low", "high", "unit",
               "better", "episodes", "rank_low", "rank_high"}  # fmt: skip
    assert columns <= set(rows[0])
    assert {row["track"] for row in rows} == {"known", "unknown", "known - unknown"}


def test_measuring_the_stored_episodes_again_gives_the_same_table(call, run):
    table = call("leaderboard", run, "--format", "csv")[1]
    assert call("leaderboard", run, "--format", "csv", "--recompute")[1] == table


def test_one_metric_can_be_asked_for_and_a_wrong_one_is_corrected(call, run):
    code, stdout, _ = call("leaderboard", run, "--metric", "path_length")
    assert code == 0
    assert "path_length" in stdout
    assert "spl" not in stdout.split("value [low")[0]
    code, _, stderr = call("leaderboard", run, "--metric", "path_lenght")
    assert code == 2
    assert "path_length" in stderr


def test_an_unfinished_run_says_so_and_a_damaged_one_is_refused(call, run):
    parts = sorted(run.glob("parts/*/*.seal.json"))
    parts[0].unlink()
    code, _, stderr = call("leaderboard", run)
    assert code == 0
    assert f"{run} holds 2 of 4 episodes" in stderr
    assert f"missing: seeds 0–1 of {parts[0].parent.name.rpartition('.')[0]}" in stderr
    damaged = next(iter(parts[1].parent.glob(f"*{RESULTS_FILE}")))
    damaged.write_bytes(b"x" * damaged.stat().st_size)
    code, stdout, stderr = call("leaderboard", run)
    assert (code, stdout) == (1, "")
    assert str(damaged) in stderr


def test_what_is_no_run_is_refused(call, tmp_path):
    code, _, stderr = call("leaderboard", tmp_path)
    assert code == 2
    assert "must be a run folder" in stderr


def test_another_suites_folder_is_refused_by_both_names(call, suite, run):
    code, _, stderr = call("run", suite, "--out", run, "--navigator", "orca", "--workers", 0)
    assert code == 1
    assert stderr.count("tiny@1 (") == 2
    assert "They differ in navigators." in stderr


def test_a_scenario_by_name_or_file_runs_as_a_suite_of_one(call, suite, tmp_path):
    chosen = ("--navigator", "straight-line", "--seeds", 1, "--workers", 0)
    for name, called in (
        (suite.parent / "open.yaml", "tiny-open@1"),
        ("trap/u:mouth=3", "trap-u@1"),
    ):
        code, stdout, stderr = call("run", name, "--out", tmp_path / called, *chosen)
        assert code == 0
        assert f"{called}: 1 scenario × 1 track × 1 navigator × 1 seed" in stderr
        assert "straight-line" in call("leaderboard", stdout.strip())[1]


def test_what_is_neither_suite_nor_scenario_is_answered_with_both(call):
    code, _, stderr = call("run", "trap/v")
    assert code == 2
    assert "the name of a scenario, or a file" in stderr
    assert "Did you mean 'trap/u'?" in stderr


def test_navigators_scenarios_tracks_and_seeds_can_be_chosen(call, suite, tmp_path):
    code, _, stderr = call(
        "run", suite, "--out", tmp_path / "o", "--workers", 0, "--seeds", "4:5", "--navigator",
        "random-walk", "--navigator", "orca", "--track", "known", "--scenario",
        tmp_path / "open.yaml",
    )  # fmt: skip
    assert code == 0
    assert "1 scenario × 1 track × 2 navigators × 1 seed" in stderr
    table = call("leaderboard", tmp_path / "o")[1]
    assert "random-walk" in table
    assert "straight-line" not in table


def test_failures_and_cells_that_are_n_a_are_told(call, suite, tmp_path, monkeypatch):
    (tmp_path / "rude.py").write_text(
        "from benchnav.navigation.navigator import Navigator, Need\n"
        "class Rude(Navigator):\n"
        "    def act(self, observation): raise ValueError('no')\n"
        "class Maps(Navigator):\n"
        "    needs = frozenset({Need.MAP})\n"
        "    def act(self, observation): return observation.velocity\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    code, _, stderr = call(
        "run", suite, "--out", tmp_path / "o", "--workers", 0, "--navigator", "rude:Rude",
        "--navigator", "rude:Maps",
    )  # fmt: skip
    assert code == 0
    reason = "act raised ValueError: no (rude.py:3)"
    assert f"failed: rude:Rude in 4 episodes: {reason}\n" in stderr
    assert "Traceback" not in stderr
    assert "n/a: rude:Maps needs a map (unknown), 1 cell" in stderr
    table = call("leaderboard", tmp_path / "o")[1]
    assert "n/a (needs a map)" in table
    assert f"rude:Rude failed in 2 of 2 worlds: {reason}." in table
    stderr = call(
        "run", suite, "--out", tmp_path / "d", "--workers", 0, "--navigator", "rude:Rude", "--debug"
    )[2]
    assert 'File "rude.py", line 3, in act\n' in stderr


def test_a_metric_that_fails_is_told_at_the_end_and_under_the_table(call, suite, tmp_path):
    def broken(episode):
        if episode.identity.navigator == "orca":
            raise ZeroDivisionError("oh")
        return episode.arrival * 0.0 + 0.5

    METRICS.register("tests_broken")(
        Metric(
            name="tests_broken",
            title="t",
            unit="",
            better="higher",
            low=0.0,
            high=1.0,
            reference="r",
            function=broken,
        )
    )
    try:
        arguments = ("--workers", "0", "--track", "known")
        code, _, stderr = call("run", suite, "--out", tmp_path / "r", *arguments)
        assert code == 0
        fault = re.search(
            r"tests_broken failed for 2 values: (ZeroDivisionError: oh \(\S+\.py:\d+\))\n", stderr
        )[1]
        for again in ((), ("--recompute",)):
            _, table, _ = call("leaderboard", tmp_path / "r", "--metric", "tests_broken", *again)
            plain = table.replace("\\_", "_")
            assert f"tests_broken of orca failed in 2 episodes: {fault}." in plain
            assert "orca is not ranked: undefined in every episode" in table
        _, text, _ = call("leaderboard", tmp_path / "r", "--format", "json")
    finally:
        del METRICS._local["tests_broken"]
    told = {(r["navigator"], r["metric"]): r["fault"] for r in json.loads(text)}
    assert told["orca", "tests_broken"] == f"failed in 2 episodes: {fault}"
    assert {fault for (who, _), fault in told.items() if who != "orca"} <= {"", "n/a: needs people"}
